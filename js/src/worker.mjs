// The worker of a RemoteSimulation, in browsers and under node.
import {serve} from "./dartcast.mjs";

serve(typeof self === "object" ? self : (await import("node:worker_threads")).parentPort);
