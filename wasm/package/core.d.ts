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

/**
 * Compiles a module: from its bytes, or the package's own impact-damper.wasm, which is read, or fetched, from beside core.js.
 * That one rejects scenes with a list of dampers.
 */
export function load(bytes?: BufferSource): Promise<Simulator>;

/** The same with lists of dampers, impact-damper-lists.wasm: a third larger. */
export function loadWithLists(): Promise<Simulator>;
