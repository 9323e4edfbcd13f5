// The objects that are selected, by name, in the order in which they came. Handles and numbers are those of the last.
export class Selection {
  names: readonly string[] = [];

  get last(): string {
    return this.names.at(-1) ?? "";
  }

  has(name: string): boolean {
    return this.names.includes(name);
  }

  take(...names: string[]): void {
    this.names = names;
  }

  // One more, or one less.
  flip(name: string): void {
    this.names = this.has(name) ? this.names.filter((other) => other !== name) : [...this.names, name];
  }

  keep(exists: (name: string) => boolean): void {
    this.names = this.names.filter(exists);
  }
}
