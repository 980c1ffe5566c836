// Stands behind unpacked.js and the program's start code (emscripten's loadProgram) in a worker's script. Holds the project's
// files in memory, and makes runs, tables and verdicts anew by the commands that made those of the page
// (figures/CMakeLists.txt).
let project;

async function unpackedProject({ program, archive }) {
  const { files, commands } = JSON.parse(new TextDecoder().decode(await unpacked(archive)));
  const module = await unpacked(program);
  return { module: new Uint8Array(module), compiled: await WebAssembly.compile(module), commands,
           sources: new Map(Object.entries(files)), made: new Map() };
}

const contentOf = (name) => project.made.get(name) ?? project.sources.get(name);

// A fresh instance of the program with a file system of its own, still empty. What it writes to its standard error comes
// into `complaints`; its standard output is not needed, results are read from files.
function loaded(complaints) {
  return new Promise((resolve, reject) => {
    loadProgram({
      thisProgram: "impact-damper",
      print: () => {},
      printErr: (line) => complaints.push(line),
      onAbort: (what) => reject(new Error(what)),
      instantiateWasm(imports, received) {
        WebAssembly.instantiate(project.compiled, imports).then(received, reject);
        return {};
      },
    }).then(resolve, reject);
  });
}

// Calls the program with the arguments `words` in a folder with the project's files and `files`, pairs of name and content.
// Returns the contents of the files `makes`; throws what the program wrote to its standard error if it fails.
async function runProgram(words, files, makes) {
  const complaints = [];
  const { FS, callMain } = await loaded(complaints);
  const given = new Map([...project.sources, ...files]);
  for (const name of [...given.keys(), ...makes]) FS.mkdirTree(`/${name}`.replace(/[^/]*$/, ""));
  for (const [name, content] of given) FS.writeFile(name, content);
  // If the program was built from uncommitted sources, its sweeps record the SHA-256 of the program, read from this file.
  FS.writeFile("/proc/self/exe", project.module);
  if (callMain(words) !== 0) throw new Error(complaints.join("\n"));
  return makes.map((name) => FS.readFile(name));
}

// The commands that are needed to make these files, inputs first, without those whose files are there already.
function commandsFor(names) {
  const makers = new Map(project.commands.flatMap((command) => command.makes.map((name) => [name, command])));
  const found = new Set();
  const visit = (name) => {
    const command = makers.get(name);
    if (contentOf(name) || found.has(command)) return;
    if (!command) throw new Error(`${name}: nothing makes it`);
    command.from.forEach(visit);
    found.add(command);
  };
  names.forEach(visit);
  return [...found];
}

const withContents = (names) => names.map((name) => [name, contentOf(name)]);

async function makeFiles(names, tell) {
  const commands = commandsFor(names);
  for (const [done, { words, from, makes }] of commands.entries()) {
    tell({ done, count: commands.length, command: words.join(" ") });
    const contents = await runProgram(words, withContents(from), makes);
    makes.forEach((name, i) => project.made.set(name, contents[i]));
  }
}

// The files that a claim of data/claims.json rests on: of each run and response that its measures name, with the members of
// ensembles; and of the scene's run beside a further run of it, as `verify` reads both.
function runsOf(claim) {
  const catalogue = JSON.parse(contentOf("figures/catalogue.json"));
  const calls = [claim.measure, ...Object.values(claim.also ?? {})];
  const names = new Set(calls.flatMap((call) => [...(call.scenes ?? []), ...(call.responses ?? [])]));
  for (const { name, scene } of catalogue.runs)
    if (names.has(name) && catalogue.scenes.some((each) => each.scene === scene)) names.add(scene);
  const runs = [...names].map((name) => `build/runs/exact/${name}.`);
  return project.commands.flatMap(({ makes }) => makes).filter((file) => runs.some((begin) =>
    file === begin + "json" || file.startsWith(begin + "members/")));
}

// The lines of the file of verdicts on these claims, by id: as text, since their hashes are compared.
async function verdictsOn(ids, tell) {
  const { schema, claims } = JSON.parse(contentOf("data/claims.json"));
  const some = claims.filter(({ id }) => ids.includes(id));
  const runs = [...new Set(some.flatMap(runsOf))];
  await makeFiles(runs, tell);
  tell({ done: 0, count: 1, command: "verify" });
  const words = ["verify", "--runs", "build/runs/exact", "--claims", "chosen.json", "--threads", "1", "-o", "verdicts.json"];
  const files = [["chosen.json", JSON.stringify({ schema, claims: some })], ...withContents(runs)];
  const [verdicts] = await runProgram(words, files, ["verdicts.json"]);
  const lines = new TextDecoder().decode(verdicts).split("\n").filter((line) => line.includes('"claim": '));
  return new Map(lines.map((line) => line.replace(/^ +|,$/g, "")).map((line) => [JSON.parse(line).claim, line]));
}

async function sha256(content) {
  const bytes = typeof content === "string" ? new TextEncoder().encode(content) : content;
  return [...new Uint8Array(await crypto.subtle.digest("SHA-256", bytes))].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}

// A request is { table: file name }, { claims: [id, ...] } or { report: { name, scene } }, where `name` is a file's name without
// a slash and `scene` its text. With `anew` everything that was made before is discarded first.
async function answerTo({ table, claims, report, anew }, tell) {
  if (anew) project.made.clear();
  if (table) {
    await makeFiles([table], tell);
    return { sha256: await sha256(project.made.get(table)) };
  }
  if (claims) {
    const hashes = [];
    for (const [id, line] of await verdictsOn(claims, tell)) hashes.push([id, await sha256(line)]);
    return { sha256: Object.fromEntries(hashes) };
  }
  const words = ["report", "--scene", report.name, "--without-figures", "--threads", "1", "-o", "page.html"];
  const [page] = await runProgram(words, [[report.name, report.scene]], ["page.html"]);
  return { page: new TextDecoder().decode(page) };
}

let ready; // the project, unpacked
let last = Promise.resolve(); // settles when all earlier requests have been answered
onmessage = ({ data }) => {
  if (data.program) {
    ready = unpackedProject(data);
    ready.catch(() => {}); // each request tells of the failure
    return;
  }
  last = last.then(async () => {
    try {
      project = await ready;
      postMessage({ answer: await answerTo(data, (progress) => postMessage({ progress })) });
    } catch (error) {
      postMessage({ error: error.message });
    }
  });
};
