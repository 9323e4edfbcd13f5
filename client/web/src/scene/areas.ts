import { SceneService } from "../../gen/lpv/v1/scene_pb.ts";
import type { Light } from "../../gen/lpv/v1/scene_pb.ts";
import { unary } from "../net/calls.ts";
import type { Connection } from "../net/connection.ts";

const PAUSE_MS = 300;

// Areas of lights, m^2 of one side: ListLights has them, what watchers are told has not. Asked for one revision of a
// light at a time, and not while it is being dragged.
export class LightAreas {
  private readonly known = new Map<string, { revision: bigint; area: number }>();
  private timer: ReturnType<typeof setTimeout> | undefined;

  constructor(private readonly connection: Connection, private readonly session: string, private readonly learned: () => void) {}

  // Of this revision of the light; undefined until the server has said so.
  of(light: Light): number | undefined {
    const known = this.known.get(light.name);
    if (known && known.revision >= (light.status?.revision ?? 0n)) return known.area;
    clearTimeout(this.timer);
    this.timer = setTimeout(() => void this.ask(), PAUSE_MS);
    return undefined;
  }

  private async ask(): Promise<void> {
    let pageToken = "";
    do {
      const page = await unary(this.connection, SceneService.method.listLights, { session: this.session, pageSize: 1000, pageToken }).catch(() => undefined);
      for (const light of page?.lights ?? []) {
        this.known.set(light.name, { revision: light.status?.revision ?? 0n, area: light.status?.area ?? 0 });
      }
      pageToken = page?.nextPageToken ?? "";
    } while (pageToken);
    this.learned();
  }
}
