// Times a decay in the WebAssembly module, as decay_time.cpp does in the library: decay_time.mjs PACKAGE SCENE COUNT.
import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

const [place, scene, count] = process.argv.slice(2);
const { load } = await import(pathToFileURL(`${place}/core.js`));
const { simulate } = await load();
const text = readFileSync(scene, "utf8");
const times = [];
let end;
for (let i = 0; i < 2 * count; ++i) {
  const begin = performance.now();
  end = simulate(text, { record: [] }).end_time;
  if (i >= count) times.push(performance.now() - begin);
}
times.sort((one, other) => one - other);
console.log(times[Math.floor(count / 2)], end);
