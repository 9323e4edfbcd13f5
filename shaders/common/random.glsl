// Numbers for choices that nothing else may depend on.

uint hashed(uint v) {
  const uint state = v * 747796405u + 2891336453u;
  const uint word = ((state >> ((state >> 28) + 4u)) ^ state) * 277803737u;
  return (word >> 22) ^ word;
}

/// In [0, 1), the k-th of a seed's, by two rounds of PCG (Jarzynski and Olano 2020, "Hash Functions for GPU Rendering").
float randomOf(uint seed, uint k) { return float(hashed(seed + hashed(k)) >> 8) / 16777216.0; }
