import type { Group, ImpactDamperError, Run, Window } from "./index.js";
export { ImpactDamperError } from "./index.js";

export const groups: Group[];

export interface Simulator {
  /** Runs a scene in the thread that calls. `scene` is JSON text; `engine` a name or JSON text. */
  simulate(
    scene: string,
    options?: { engine?: string; record?: Group[]; history?: Window; file?: boolean },
  ): Run;
}

/** Compiles the module, from the bytes of impact-damper.wasm; without them it is read, or fetched, from beside core.js. */
export function load(bytes?: BufferSource): Promise<Simulator>;
