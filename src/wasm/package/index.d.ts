/** A scene, as in a scene file: data/schema/scene.schema.json. */
export interface Scene {
  mass_ratio?: number;
  restitution?: number;
  x0?: number;
  until_time?: number;
  until_amplitude?: number;
  [name: string]: unknown;
}

export type EngineName = "exact" | "restitution" | "cem";

export type Group = "half_cycles" | "impacts" | "contacts" | "energy" | "history" | "loss";

/** Equally spaced samples of the motion, both ends included; times are divided by 1/Omega_n. */
export interface Window {
  /** 0 <= begin < end <= 1e12 */
  begin: number;
  end: number;
  /** 2 to 500000 */
  count: number;
}

export interface Options {
  /** Default "exact"; an object has the members of `engine` in a run file, of which only `name` must be given. */
  engine?: EngineName | { name: EngineName; [option: string]: unknown };
  /** What the result is to hold; default all. What is left out takes no time, energy most of all. */
  record?: Group[];
  /** Which part of the motion is sampled; without it none is. */
  history?: Window;
  /** Whether the result holds the text of the run file, as the program writes it; default false. */
  file?: boolean;
  /** Ends the run, which then rejects with the signal's reason. */
  signal?: AbortSignal;
}

/** Columns of a run file. All numbers are dimensionless, also of a scene in units; an absent number is NaN. */
export interface Columns {
  [name: string]: Float64Array | number | Columns | Columns[];
}

export interface Run {
  /** "time", "amplitude", or the budget that was reached. */
  stop_reason: string;
  end_time: number;
  half_cycles?: Columns & Record<"zero_crossing" | "peak_time" | "amplitude" | "impacts", Float64Array>;
  /** `wall` is 0 (left) or 1 (right); `damper` counts from 1, and is there if the scene has a list of them. */
  impacts?: Columns &
    Record<"time" | "wall" | "relative_velocity" | "phase_deg" | "amplitude" | "displacement", Float64Array>;
  contacts?: Columns & Record<"begin" | "end" | "wall", Float64Array>;
  energy?: Columns & Record<"impact_loss", Float64Array> &
    Record<"impact_loss_total" | "contact_loss" | "bounce_downs" | "bounce_down_loss" | "viscous_work" | "forcing_work" | "residual", number>;
  history?: Columns & Record<"time" | "x" | "v", Float64Array>;
  /** The averaged loss factor per radian, from the peaks, as in the paper's Figures 8 to 14. */
  loss?: Record<"amplitude" | "time" | "eta", Float64Array>;
  /**
   * The amplitude at which the mass no longer sticks in each half cycle; NaN if it never did, or does so to the end, and
   * without "contacts".
   */
  bounce_down_end: number;
  file?: string;
}

/** A scene that is not valid, or a run that failed; the message has one line for each problem. */
export class ImpactDamperError extends Error {
  constructor(kind: "invalid" | "numerical" | "memory", message: string);
  kind: "invalid" | "numerical" | "memory";
}

/**
 * Runs a scene, given as an object or as the text of a scene file, in a thread of its own. Calls are worked through
 * one after the other. Rejects with an ImpactDamperError, or with the signal's reason.
 */
export function run(scene: Scene | string, options?: Options): Promise<Run>;
