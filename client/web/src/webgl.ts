type Context = WebGLRenderingContext | WebGL2RenderingContext;

// What a context is drawn by.
export function rendererName(gl: Context): string {
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  return String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
}

// Whether the processor draws, which has other things to do.
export function isSoftware(gl: Context): boolean {
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(rendererName(gl));
}
