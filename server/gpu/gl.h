#pragma once
// OpenGL 4.5 core, every entry point from libOpenGL itself.

#ifndef GL_GLEXT_PROTOTYPES
#define GL_GLEXT_PROTOTYPES
#endif
#include <GL/glcorearb.h>
