// What comes behind the program's start code in a worker of the page: the project in memory, and the program, which makes
// the runs, tables and verdicts anew by the commands that made those of the page (figures/CMakeLists.txt).
let project;

async function unpackedProject({ program, archive }) {
  const { files, commands } = JSON.parse(new TextDecoder().decode(await unpacked(archive)));
  const module = await unpacked(program);
  return { module: new Uint8Array(module), compiled: await WebAssembly.compile(module), commands,
           sources: new Map(Object.entries(files)), made: new Map() };
}

const contentOf = (name) => project.made.get(name) ?? project.sources.get(name);

// The program, with files of its own, of which there are none yet; its complaints are put into `complaints`.
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

// Calls the program, which finds the project's own files and `files`, a map of names to contents, below its current folder.
// Returns what it wrote to the files `makes`; throws what it complained of.
async function runProgram(words, files, makes) {
  const complaints = [];
  const { FS, callMain } = await loaded(complaints);
  const given = new Map([...project.sources, ...files]);
  for (const name of [...given.keys(), ...makes]) FS.mkdirTree(`/${name}`.replace(/[^/]*$/, ""));
  for (const [name, content] of given) FS.writeFile(name, content);
  // Built from sources that are not committed a sweep writes the SHA-256 of its program, which it reads here.
  FS.writeFile("/proc/self/exe", project.module);
  if (callMain(words) !== 0) throw new Error(complaints.join("\n"));
  return makes.map((name) => FS.readFile(name));
}

// The commands that make these files and what they are made from, as far as it is not there, in their order.
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

// The runs and responses that a claim of data/claims.json rests on, with the members of their ensembles.
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

// The lines of the file of verdicts on these claims, by id.
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

// A request is one of: { table }, its file's name; { claims }, their ids; { report: { name, scene } }, the page about a scene
// file of that name, which has no slash. `anew`: of what was made before nothing is used.
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
  const words = ["report", "--scene", report.name, "--without-figures", "--threads", "1", "-o", "/page/page.html"];
  const [page] = await runProgram(words, [[report.name, report.scene]], ["page/page.html"]);
  return { page: new TextDecoder().decode(page) };
}

let ready; // the project, unpacked
let last = Promise.resolve(); // the request before
onmessage = ({ data }) => {
  if (data.program) {
    ready = unpackedProject(data);
    ready.catch(() => {}); // told to whoever asks
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
