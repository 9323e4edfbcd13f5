#pragma once
// Included before everything else where ThreadSanitizer is on. Debian's libprotobuf was built without it, and under GCC
// its headers would then give maps two more members than the library knows of.

#include <memory>  // and with it the standard library's own knowledge of the sanitizer

#pragma push_macro("__SANITIZE_THREAD__")
#undef __SANITIZE_THREAD__
#include <google/protobuf/map_field.h>
#pragma pop_macro("__SANITIZE_THREAD__")
