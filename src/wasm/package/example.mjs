// How long a damper of 2 % of the mass needs until the amplitude is a quarter of the clearance.
import { run } from "impact-damper";

const { end_time, half_cycles, impacts, energy } = await run({
  mass_ratio: 0.02,
  restitution: 0.6,
  x0: 6,
  until_amplitude: 0.25,
});
console.log(`${(end_time / (2 * Math.PI)).toFixed(1)} periods, ${impacts.time.length} impacts`);
console.log(`largest amplitude ${half_cycles.amplitude[0].toFixed(3)}, energy balance to ${energy.residual.toExponential(0)}`);
