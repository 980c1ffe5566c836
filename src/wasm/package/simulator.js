// The simulation itself, in the thread that calls it: scenes and engines as JSON text, columns as typed arrays. It knows
// nothing of files and networks, so that a page can hold it.
/** A scene that is not valid, or a run that failed. `kind` is "invalid", "numerical" or "memory". */
export class ImpactDamperError extends Error {
  constructor(kind, message) {
    super(message);
    this.name = "ImpactDamperError";
    this.kind = kind;
  }
}

// What may be left out of a run; all else is always in it. What is left out takes no time, energy most of all.
export const groups = ["half_cycles", "impacts", "contacts", "energy", "history", "loss"];

const recorded = { impacts: 1, contacts: 2, energy: 4 }; // impact_damper_record

const kinds = [undefined, "invalid", "numerical", "memory"]; // impact_damper_status
const longestError = 16384;

// What the module asks of where it runs: there are no surroundings that it could depend on.
function surroundings(memory) {
  const noVariables = (count, bytes) => {
    new DataView(memory().buffer).setUint32(count, 0, true);
    new DataView(memory().buffer).setUint32(bytes, 0, true);
    return 0;
  };
  return {
    env: { emscripten_notify_memory_growth() {} },
    wasi_snapshot_preview1: {
      environ_sizes_get: noVariables,
      environ_get: () => 0,
      proc_exit(code) {
        throw new Error(`the module ended with code ${code}`);
      },
    },
  };
}

/** Compiles the module out of its bytes. */
export async function load(bytes) {
  const { instance } = await WebAssembly.instantiate(bytes, surroundings(() => module.memory));
  const module = instance.exports;
  module._initialize();

  // The memory that is taken for one call, given back whatever happens.
  function withMemory(use) {
    const taken = [];
    const take = (bytes) => {
      const place = module.malloc(bytes);
      if (place === 0) throw new ImpactDamperError("memory", "not enough memory");
      taken.push(place);
      return place;
    };
    try {
      return use(take);
    } finally {
      taken.forEach((place) => module.free(place));
    }
  }

  // Memory may have moved since the last call: its views are asked for anew each time.
  const view = () => new DataView(module.memory.buffer);
  const bytesOfMemory = () => new Uint8Array(module.memory.buffer);

  function textAt(place) {
    const bytes = bytesOfMemory();
    return new TextDecoder().decode(bytes.slice(place, bytes.indexOf(0, place)));
  }

  function putText(text, take) {
    const bytes = new TextEncoder().encode(text + "\0");
    const place = take(bytes.length);
    bytesOfMemory().set(bytes, place);
    return place;
  }

  function putWindow(window, take) {
    if (!window) return 0;
    const place = take(24); // struct impact_damper_window: two doubles, a size
    view().setFloat64(place, window.begin, true);
    view().setFloat64(place + 8, window.end, true);
    view().setUint32(place + 16, window.count, true);
    return place;
  }

  // "history/x" becomes result.history.x, and "history/dampers/1/y" result.history.dampers[0].y, as in a run file.
  function put(result, path, value) {
    const names = path.split("/");
    const last = names.pop();
    let place = result;
    for (const name of names) {
      const number = Number(name);
      place = number ? (place[number - 1] ??= {}) : (place[name] ??= name === "dampers" ? [] : {});
    }
    place[last] = value;
  }

  function columnsOf(run, record, take) {
    const standsAlone = take(4);
    const rows = take(4);
    const result = {};
    for (let index = 0; ; ++index) {
      const name = module.impact_damper_column_name(run, index, standsAlone);
      if (name === 0) return result;
      const path = textAt(name);
      const group = path.split("/")[0];
      if (groups.includes(group) && !record.includes(group)) continue;
      const values = module.impact_damper_column(run, name, rows);
      const column = new Float64Array(module.memory.buffer, values, view().getUint32(rows, true));
      const alone = view().getInt32(standsAlone, true) === 1;
      put(result, path, alone ? column[0] : column.slice());
    }
  }

  function lossOf(run, take) {
    const rows = take(4);
    module.impact_damper_column(run, putText("half_cycles/amplitude", take), rows);
    const most = view().getUint32(rows, true);
    const places = [0, 1, 2].map(() => take(8 * most + 8)); // never nothing
    const count = module.impact_damper_loss_factor(run, ...places);
    const [amplitude, time, eta] = places.map((place) => new Float64Array(module.memory.buffer, place, count).slice());
    return { amplitude, time, eta };
  }

  function fileOf(run) {
    const text = module.impact_damper_run_text(run);
    if (text === 0) throw new ImpactDamperError("memory", "not enough memory for the run file");
    const file = textAt(text);
    module.free(text);
    return file;
  }

  /** Runs a scene: see `run` in index.d.ts. `scene` and `engine` are JSON text, or a name of an engine. */
  function simulate(scene, { engine = "exact", record = groups, history, file = false } = {}) {
    record = [...new Set(record)];
    const unknown = record.find((name) => !groups.includes(name));
    if (unknown !== undefined)
      throw new ImpactDamperError("invalid", `record: must be of ${groups.join(", ")}, got ${unknown}`);
    return withMemory((take) => {
      const place = take(4);
      const error = take(longestError);
      const sections = record.reduce((sum, name) => sum + (recorded[name] ?? 0), 0);
      const status = module.impact_damper_simulate_recording(
        putText(scene, take), putText(engine, take), sections, putWindow(history, take), place, error, longestError);
      const run = view().getUint32(place, true);
      if (status !== 0) throw new ImpactDamperError(kinds[status], textAt(error));
      try {
        const result = columnsOf(run, record, take);
        result.bounce_down_end = module.impact_damper_bounce_down_end(run);
        if (record.includes("loss")) result.loss = lossOf(run, take);
        result.stop_reason = textAt(module.impact_damper_stop_reason(run));
        if (file) result.file = fileOf(run);
        return result;
      } finally {
        module.impact_damper_free(run);
      }
    });
  }

  return { simulate };
}
