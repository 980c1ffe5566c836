// What comes behind the program's start code in a worker of the page: the project in memory, and the program, which makes
// the runs, tables and verdicts anew by the commands that made those of the page (figures/CMakeLists.txt).
let project;

async function unpacked(bytes) {
  return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
}

async function opened({ program, archive }) {
  const { files, commands } = JSON.parse(new TextDecoder().decode(await unpacked(archive)));
  const module = await unpacked(program);
  return { module: new Uint8Array(module), program: await WebAssembly.compile(module), commands,
           sources: new Map(Object.entries(files)), made: new Map() };
}

const fileOf = ({ sources, made }, name) => made.get(name) ?? sources.get(name);

// Calls the program, which finds the project's own files and those called `from` below its current folder. Returns what it
// wrote to the files `makes`; throws what it complained of.
async function called(words, from, makes) {
  const complaints = [];
  const { FS, callMain } = await loadProgram({
    thisProgram: "impact-damper",
    print: () => {},
    printErr: (line) => complaints.push(line),
    instantiateWasm(imports, received) {
      WebAssembly.instantiate(project.program, imports).then((instance) => received(instance));
      return {};
    },
  });
  const put = (name) => FS.writeFile(name, fileOf(project, name));
  for (const name of [...project.sources.keys(), ...from, ...makes]) FS.mkdirTree(`/${name}`.replace(/[^/]*$/, ""));
  for (const name of new Set([...project.sources.keys(), ...from])) put(name);
  FS.writeFile("/proc/self/exe", project.module); // of an uncommitted state a sweep tells the program's own digest
  const code = callMain(words);
  if (code !== 0) throw new Error(complaints.join("\n"));
  return makes.map((name) => FS.readFile(name));
}

// The commands that make these files and what they are made from, as far as it is not there, in their order.
function commandsFor(names) {
  const makers = new Map(project.commands.flatMap((command) => command.makes.map((name) => [name, command])));
  const found = new Set();
  const visit = (name) => {
    const command = makers.get(name);
    if (fileOf(project, name) || found.has(command)) return;
    if (!command) throw new Error(`${name}: nothing makes it`);
    command.from.forEach(visit);
    found.add(command);
  };
  names.forEach(visit);
  return [...found];
}

async function make(names, tell) {
  const commands = commandsFor(names);
  for (const [done, { words, from, makes }] of commands.entries()) {
    tell({ done, count: commands.length, command: words.join(" ") });
    const files = await called(words, from, makes);
    makes.forEach((name, i) => project.made.set(name, files[i]));
  }
}

// The runs and responses that a claim of data/claims.json rests on, with the members of their ensembles.
function runsOf(claim) {
  const catalogue = JSON.parse(fileOf(project, "figures/catalogue.json"));
  const calls = [claim.measure, ...Object.values(claim.also ?? {})];
  const names = new Set(calls.flatMap((call) => [...(call.scenes ?? []), ...(call.responses ?? [])]));
  for (const { name, scene } of catalogue.runs)
    if (names.has(name) && catalogue.scenes.some((each) => each.scene === scene)) names.add(scene);
  const runs = [...names].map((name) => `build/runs/exact/${name}.`);
  return project.commands.flatMap(({ makes }) => makes).filter((file) => runs.some((begin) =>
    file === begin + "json" || file.startsWith(begin + "members/")));
}

// The lines of the file of verdicts on these claims, by id.
async function verdictsOn(ids, tell) {
  const { schema, claims } = JSON.parse(fileOf(project, "data/claims.json"));
  const some = claims.filter(({ id }) => ids.includes(id));
  const runs = [...new Set(some.flatMap(runsOf))];
  await make(runs, tell);
  tell({ done: 0, count: 1, command: "verify" });
  const [chosen, verdicts] = ["build/claims.json", "build/verdicts.json"];
  project.made.set(chosen, JSON.stringify({ schema, claims: some }));
  const words = ["verify", "--runs", "build/runs/exact", "--claims", chosen, "--threads", "1", "-o", verdicts];
  const [file] = await called(words, [chosen, ...runs], [verdicts]);
  const lines = new TextDecoder().decode(file).split("\n").filter((line) => line.includes('"claim": '));
  return new Map(lines.map((line) => line.replace(/^ +|,$/g, "")).map((line) => [JSON.parse(line).claim, line]));
}

async function sha256(content) {
  const bytes = typeof content === "string" ? new TextEncoder().encode(content) : content;
  return [...new Uint8Array(await crypto.subtle.digest("SHA-256", bytes))].map((byte) => byte.toString(16).padStart(2, "0")).join("");
}

async function answered({ table, claims, report }, tell) {
  if (report) {
    project.made.set(report.name, report.scene);
    const words = ["report", "--scene", report.name, "--without-figures", "--threads", "1", "-o", "page.html"];
    const [page] = await called(words, [report.name], ["page.html"]);
    return { page: new TextDecoder().decode(page) };
  }
  if (table) {
    await make([table], tell);
    return { sha256: await sha256(project.made.get(table)) };
  }
  const hashes = [];
  for (const [id, line] of await verdictsOn(claims, tell)) hashes.push([id, await sha256(line)]);
  return { sha256: Object.fromEntries(hashes) };
}

let ready; // the project, opened
let last = Promise.resolve(); // the request before
onmessage = ({ data }) => {
  if (data.program) {
    ready = opened(data);
    return;
  }
  last = last.then(async () => {
    try {
      project = await ready;
      postMessage(await answered(data, (progress) => postMessage({ progress })));
    } catch (error) {
      postMessage({ error: error.message });
    }
  });
};
