// The simulation in the thread that calls it, with the modules from beside this file.
import { load as loadFrom } from "./simulator.js";

export { ImpactDamperError, groups } from "./simulator.js";

// Read in node, fetched in a browser.
async function ownBytes(name) {
  const address = new URL(name, import.meta.url);
  if (globalThis.process?.versions?.node) return (await import("node:fs/promises")).readFile(address);
  return (await fetch(address)).arrayBuffer();
}

/** Compiles a module: from its `bytes`, or the one of this package that has no lists of dampers. */
export async function load(bytes) {
  return loadFrom(bytes ?? (await ownBytes("./impact-damper.wasm")));
}

/** Compiles the module of this package that has them. */
export async function loadWithLists() {
  return loadFrom(await ownBytes("./impact-damper-lists.wasm"));
}
