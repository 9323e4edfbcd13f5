// The files of one drop. What one of them names is looked for among the others, and nowhere else.
export class DroppedFiles {
  private readonly taken = new Set<File>();

  constructor(readonly all: readonly File[]) {}

  // By the last part of a path or URI, since what is dropped has no folders. It then belongs to the file that named it.
  find(uri: string): File | undefined {
    const name = lastPart(uri);
    const found = this.all.find((one) => one.name === name);
    if (found) this.taken.add(found);
    return found;
  }

  // Whether another file has asked for it.
  isPartOfAnother(file: File): boolean {
    return this.taken.has(file);
  }
}

export function lastPart(uri: string): string {
  return percentDecoded(uri).replaceAll("\\", "/").split("/").pop() ?? "";
}

function percentDecoded(text: string): string {
  try {
    return decodeURIComponent(text);
  } catch {
    return text; // a per cent sign that means itself
  }
}

// The bytes that a URI itself holds; undefined where it names a file.
export function bytesWithin(uri: string): Uint8Array<ArrayBuffer> | undefined {
  const inline = /^data:([^,]*),/.exec(uri);
  if (!inline) return undefined;
  const text = uri.slice(inline[0].length);
  const letters = /;base64$/.test(inline[1] ?? "") ? atob(text) : percentDecoded(text);
  return Uint8Array.from(letters, (letter) => letter.charCodeAt(0));
}
