// Runs scenes by the package that is installed here: runs.mjs JOBS; JOBS is JSON, [{scene, options, file}].
// Writes the text of each run file, or what is wrong with the scene, and checks the columns against that text.
import { readFileSync, writeFileSync } from "node:fs";
import { run } from "impact-damper";

// The typed array, or number, that stands for each list of a run file; null is an absent number, a wall its place.
function different(column, value, path) {
  if (value === null) return Number.isNaN(column) ? [] : [path];
  if (typeof value === "number") return Object.is(column, value) ? [] : [path];
  if (Array.isArray(value))
    return value.flatMap((each, i) => different(column?.[i], { left: 0, right: 1 }[each] ?? each, `${path}/${i}`));
  return Object.keys(value).flatMap((name) => different(column?.[name], value[name], `${path}/${name}`));
}

for (const { scene, options, file } of JSON.parse(readFileSync(process.argv[2], "utf8"))) {
  try {
    const result = await run(scene, { ...options, file: true });
    writeFileSync(file, result.file);
    const written = JSON.parse(result.file);
    for (const group of ["half_cycles", "impacts", "contacts", "energy"].filter((name) => name in written)) {
      const wrong = different(result[group], written[group], group);
      if (wrong.length > 0) console.log(`${file}: ${wrong.length} numbers are not those of the run file: ${wrong[0]}`);
    }
  } catch (error) {
    if (error.name !== "ImpactDamperError") throw error;
    writeFileSync(file, `${error.kind}\n${error.message}\n`);
  }
}
