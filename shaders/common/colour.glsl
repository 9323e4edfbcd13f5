/// Of its channels.
float largest(vec3 c) { return max(max(c.r, c.g), c.b); }
