#pragma once

#include "session/document/document.h"

namespace lpv::test {

/// The same objects with the same content, deletions, settings and revisions.
void expectSame(const Changes& a, const Changes& b);

}  // namespace lpv::test
