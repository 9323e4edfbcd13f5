// Headers and VPLs of the tree where they are written (shaders/transport/vpls.glsl).

layout(std430, binding = kTreeEntries) buffer Entries { vec4 entries[]; };

void storeVpl(uint entry, Vpl v) {
  const int at = int(entry) * kEntryTexels;
  entries[at] = vec4(v.position, v.area);
  entries[at + 1] = vec4(v.direction, v.spread);
  const mat3 e = v.positionCovariance;
  entries[at + 2] = vec4(e[0][0], e[1][1], e[2][2], e[0][0] + e[1][1] + e[2][2]);
  entries[at + 3] = vec4(e[0][1], e[0][2], e[1][2], 2.0 / params.cell);
#if LPV_TEXTURED
  entries[at + 4] = vec4(v.colour, 0.0);
#endif
}

Vpl vplAt(uint entry) {
  const int at = int(entry) * kEntryTexels;
  Vpl v;
  v.position = entries[at].xyz;
  v.area = entries[at].w;
  v.direction = entries[at + 1].xyz;
  v.spread = entries[at + 1].w;
  const vec3 d = entries[at + 2].xyz, o = entries[at + 3].xyz;
  v.positionCovariance = mat3(d.x, o.x, o.y, o.x, d.y, o.z, o.y, o.z, d.z);
#if LPV_TEXTURED
  v.colour = entries[at + 4].rgb;
#endif
  return v;
}
