// The simulation in the thread that calls it, with the module from beside this file.
import { load as loadFrom } from "./simulator.js";

export { ImpactDamperError, groups } from "./simulator.js";

// Read in node, fetched in a browser.
async function ownBytes() {
  const address = new URL("./impact-damper.wasm", import.meta.url);
  if (globalThis.process?.versions?.node) return (await import("node:fs/promises")).readFile(address);
  return (await fetch(address)).arrayBuffer();
}

/** Compiles the module, from `bytes` or from the file beside this one. */
export async function load(bytes) {
  return loadFrom(bytes ?? (await ownBytes()));
}
