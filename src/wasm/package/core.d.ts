import type { Group, ImpactDamperError, Run, Window } from "./index.js";
export { ImpactDamperError } from "./index.js";

export const groups: Group[];

export interface Simulator {
  /**
   * Runs a scene in the thread that calls, which waits for it. `scene` is JSON text, `engine` a name or JSON text; the
   * options are those of `run` in index.d.ts.
   */
  simulate(
    scene: string,
    options?: { engine?: string; record?: Group[]; history?: Window; file?: boolean },
  ): Run;
}

/**
 * Compiles a module from its bytes. Without them it is the package's impact-damper.wasm, which node reads, and a browser
 * fetches, from beside core.js: it rejects scenes with a list of dampers.
 */
export function load(bytes?: BufferSource): Promise<Simulator>;

/** Compiles the package's impact-damper-lists.wasm, a third larger, which runs every scene. */
export function loadWithLists(): Promise<Simulator>;
