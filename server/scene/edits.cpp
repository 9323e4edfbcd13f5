#include "scene/edits.h"

#include "scene/words.h"

namespace lpv {

Status checkName(const std::string& name) { return checkWords("name", name, 1, kMaxNameBytes); }

}  // namespace lpv
