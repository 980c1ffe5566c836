// What the declarations allow, and what they do not: compiled only.
import { run, ImpactDamperError, type Run } from "impact-damper";
import { load, loadWithLists } from "impact-damper/core";

const result: Run = await run({ mass_ratio: 0.02, x0: 6, until_time: 10 }, { engine: { name: "cem", time_step: 1e-4 } });
const first: number | undefined = result.impacts?.time[0];
const stop: string = result.stop_reason;
await run("{}", { record: ["impacts"], history: { begin: 0, end: 1, count: 2 }, signal: new AbortController().signal });
const text: string | undefined = (await load()).simulate("{}", { engine: "exact", file: true }).file;
const more: Run = (await loadWithLists()).simulate('{"dampers": [{}]}');
const kind: "invalid" | "numerical" | "memory" = new ImpactDamperError("invalid", "").kind;
console.log(first, stop, text, more, kind);
// @ts-expect-error no such engine
await run({}, { engine: "euler" });
// @ts-expect-error no such group
await run({}, { record: ["peaks"] });
// @ts-expect-error a column is no text
const wrong: string = result.impacts?.time;
