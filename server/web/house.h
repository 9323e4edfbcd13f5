#pragma once
// What the connections of a door share.

#include <memory>
#include <string>

#include "api/call/context.h"
#include "web/files.h"
#include "web/guests.h"
#include "web/origins.h"
#include "web/places.h"

namespace lpv::web_door {

/// Where a connection comes from and has come to.
struct Arrival {
  std::string peer;
  std::string network;  ///< api::networkOf()
  bool shared = false;  ///< many clients are behind it
  Origins::Local local;
};

/// What all connections share.
struct House {
  const api::Context& context;
  const Origins origins;
  const Files files;
  Places places{};
  Guests guests{};
};

}  // namespace lpv::web_door
