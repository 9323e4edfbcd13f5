#include "convert/session.h"

#include <algorithm>
#include <limits>
#include <set>

#include "base/text.h"
#include "convert/geometry.h"
#include "scene/error_goal.h"
#include "scene/words.h"

namespace lpv::api {
namespace {

constexpr char kPrefix[] = "sessions/";
constexpr std::size_t kMaxDisplayName = 200;
constexpr std::int64_t kMaxTtlSeconds = 10LL * 365 * 24 * 3600;

Status unknownValue(const char* field, int value) {
  return invalid(field, std::string(field) + " has the unknown value " + std::to_string(value));
}

/// Copies an enum whose wire values are 1 + the domain's, leaving the default for 0.
template <typename Wire, typename Domain>
Status take(const char* field, Wire wire, int highest, Domain* out) {
  const int value = static_cast<int>(wire);
  if (value < 0 || value > highest) return unknownValue(field, value);
  if (value > 0) *out = static_cast<Domain>(value - 1);
  return {};
}

template <typename Wire, typename Domain>
Wire wireOf(Domain value) {
  return static_cast<Wire>(static_cast<int>(value) + 1);
}

static_assert(pb::INJECTION_COUNT == 1 + static_cast<int>(Injection::kCount));
static_assert(pb::INJECTION_FLUX == 1 + static_cast<int>(Injection::kFlux));
static_assert(pb::INJECTION_METHOD_DENSE == 1 + static_cast<int>(InjectionMethod::kDense));
static_assert(pb::INJECTION_METHOD_RASTER == 1 + static_cast<int>(InjectionMethod::kRaster));
static_assert(pb::TRANSPORT_GATHER == 1 + static_cast<int>(Transport::kGather));
static_assert(pb::TRANSPORT_DIRECT == 1 + static_cast<int>(Transport::kDirect));
static_assert(pb::TRANSPORT_AUTO == 1 + static_cast<int>(Transport::kAuto));
static_assert(pb::QUALITY_ACCURATE == 1 + static_cast<int>(Quality::kAccurate));
static_assert(pb::LOOKUP_CAP == 1 + static_cast<int>(Lookup::kCap));
static_assert(pb::LOOKUP_NEAREST == 1 + static_cast<int>(Lookup::kNearest));
static_assert(pb::GLOSS_OFF == 1 + static_cast<int>(Gloss::kOff));
static_assert(pb::VISIBILITY_OFF == 1 + static_cast<int>(Visibility::kOff));

Expected<GridOptions> gridFromProto(const pb::GridSettings& in) {
  GridOptions out;
  switch (in.size_case()) {
    case pb::GridSettings::kLongest:
      if (in.longest() == 0) return invalid("longest", "grid.longest is 0, allowed are 1..128 cells along an axis");
      out.longest = in.longest();
      break;
    case pb::GridSettings::kDims:
      out.dims = {in.dims().x(), in.dims().y(), in.dims().z()};
      if (out.dims == glm::ivec3(0))
        return invalid("dims", "grid.dims is 0, 0, 0, allowed are 1..128 cells along an axis");
      break;
    case pb::GridSettings::kAutomatic:
      out.automatic = in.automatic();
      break;
    case pb::GridSettings::SIZE_NOT_SET:
      break;
  }
  out.hasBounds = in.has_bounds();
  if (out.hasBounds) out.bounds = fromProto(in.bounds());
  return out;
}

using Names = std::set<std::string>;

/// What a session has that was not told.
int defaultBounces(Transport transport) { return transport == Transport::kPropagate ? 0 : kAutoBounces; }

/// Transport, injection, lookup and bounces, each with the default that the others give it: the named ones as they are
/// asked for, the others as they belong to the transport where that is another one now.
Status takeTransport(const Names& named, const pb::SessionSettings& in, LightingSettings* o) {
  const Transport before = o->transport;
  if (named.contains("transport")) {
    const bool paper = named.contains("injection") && in.injection() == pb::INJECTION_COUNT;
    const bool dense = o->method == InjectionMethod::kDense;
    o->transport = paper || dense ? Transport::kPropagate : Transport::kGather;
    if (Status s = take("transport", in.transport(), 4, &o->transport); !s.ok()) return s;
  }
  const bool changed = o->transport != before;
  LightingSettings belonging = *o;
  belonging.followTransport();
  if (changed || named.contains("injection")) o->injection = belonging.injection;
  if (changed || named.contains("lookup")) o->lookup = belonging.lookup;
  if (changed || named.contains("bounces")) o->bounces = defaultBounces(o->transport);
  if (named.contains("bounces") && in.has_bounces()) o->bounces = in.bounces();
  if (named.contains("injection")) {
    if (Status s = take("injection", in.injection(), 2, &o->injection); !s.ok()) return s;
  }
  return named.contains("lookup") ? take("lookup", in.lookup(), 3, &o->lookup) : Status();
}

/// One settings field by its name within SessionSettings; takeTransport's stay as they are.
Status takeField(const std::string& field, const pb::SessionSettings& in, SessionSettings* out) {
  LightingSettings& o = out->options;
  if (field == "grid") {
    const Expected<GridOptions> grid = gridFromProto(in.grid());
    if (!grid) return grid.status().within("grid");
    o.grid = *grid;
    return {};
  }
  const LightingSettings defaults;
  static const Names together = {"transport", "injection", "lookup", "bounces"};
  if (together.contains(field)) return {};
  if (field == "method") return o.method = defaults.method, take("method", in.method(), 3, &o.method);
  if (field == "dense_samples") return o.denseSamples = in.dense_samples(), Status();
  if (field == "quality") return o.quality = defaults.quality, take("quality", in.quality(), 2, &o.quality);
  if (field == "iterations") return o.iterations = in.iterations(), Status();
  if (field == "clamp_faces") return o.clampFaces = in.clamp_faces(), Status();
  if (field == "k") return o.k = in.k(), Status();
  if (field == "max_error") return o.maxError = in.max_error(), Status();
  if (field == "visibility")
    return o.visibility = defaults.visibility, take("visibility", in.visibility(), 3, &o.visibility);
  if (field == "gloss") return o.gloss = defaults.gloss, take("gloss", in.gloss(), 2, &o.gloss);
  if (field == "haze") return o.haze = in.haze(), Status();
  if (field == "haze_absorption") return o.hazeAbsorption = in.haze_absorption(), Status();
  if (field == "haze_anisotropy") return o.hazeAnisotropy = in.haze_anisotropy(), Status();
  if (field == "display_name") {
    if (in.display_name().size() > kMaxDisplayName) return invalid("display_name", "display_name is above 200 bytes");
    if (Status s = checkVisible("display_name", in.display_name()); !s.ok()) return s;
    out->policy.displayName = in.display_name();
    return {};
  }
  if (field == "ttl") {
    const std::int64_t seconds = in.has_ttl() ? in.ttl().seconds() : 3600;
    if (seconds < 0 || seconds > kMaxTtlSeconds) {
      return invalid("ttl", "ttl is " + std::to_string(seconds) + " s, allowed are 0 (never) to 10 years");
    }
    out->policy.ttl = std::chrono::seconds(seconds);
    return {};
  }
  return invalid("update_mask", "update_mask has the unknown path \"settings." + field + "\"");
}

Status takeFields(const Names& named, const pb::SessionSettings& in, SessionSettings* out) {
  for (const std::string& field : named) {
    if (Status s = takeField(field, in, out); !s.ok()) return s.within("settings");
  }
  return takeTransport(named, in, &out->options).within("settings");
}

const Names& allFields() {
  static const Names all = {"grid",        "injection",   "method", "dense_samples",   "transport",       "quality",
                            "iterations",  "clamp_faces", "k",      "lookup",          "max_error",       "visibility",
                            "bounces",     "gloss",       "haze",   "haze_absorption", "haze_anisotropy", "ttl",
                            "display_name"};
  return all;
}

}  // namespace

Expected<std::string> sessionId(const std::string& field, const std::string& name) {
  if (name.starts_with(kPrefix) && name.size() > sizeof kPrefix - 1) return name.substr(sizeof kPrefix - 1);
  return invalid(field, field + " is \"" + truncatedUtf8(name) + "\", the form is \"sessions/{id}\"");
}

std::string sessionName(const std::string& id) { return kPrefix + id; }

Expected<SessionSettings> fromProto(const pb::SessionSettings& settings) {
  SessionSettings out;
  if (Status s = takeFields(allFields(), settings, &out); !s.ok()) return s;
  return out;
}

Expected<SessionSettings> withMask(const SessionSettings& current, const pb::SessionSettings& settings,
                                   const google::protobuf::FieldMask& mask) {
  if (mask.paths().empty()) return invalid("update_mask", "update_mask names no field; say what shall change");
  Names named;
  for (const std::string& path : mask.paths()) {
    constexpr char kSettings[] = "settings.";
    if (!path.starts_with(kSettings)) {
      return invalid("update_mask",
                     "update_mask has the path \"" + path + "\"; what can change is below \"settings.\"");
    }
    const std::string field = path.substr(sizeof kSettings - 1);
    named.insert(field.substr(0, field.find('.')));
  }
  SessionSettings out = current;
  if (Status s = takeFields(named, settings, &out); !s.ok()) return s;
  return out;
}

void toProto(const LightingSettings& o, pb::SessionSettings* out) {
  if (o.grid.dims != glm::ivec3(0)) {
    out->mutable_grid()->mutable_dims()->set_x(o.grid.dims.x);
    out->mutable_grid()->mutable_dims()->set_y(o.grid.dims.y);
    out->mutable_grid()->mutable_dims()->set_z(o.grid.dims.z);
  } else if (o.grid.automatic) {
    out->mutable_grid()->set_automatic(true);
  } else if (o.grid.longest != 0) {
    out->mutable_grid()->set_longest(o.grid.longest);
  }
  if (o.grid.hasBounds) toProto(o.grid.bounds, out->mutable_grid()->mutable_bounds());
  out->set_injection(wireOf<pb::Injection>(o.injection));
  out->set_method(wireOf<pb::InjectionMethod>(o.method));
  out->set_dense_samples(o.denseSamples);
  out->set_transport(wireOf<pb::Transport>(o.transport));
  out->set_quality(wireOf<pb::Quality>(o.quality));
  out->set_iterations(o.iterations);
  out->set_clamp_faces(o.clampFaces);
  out->set_k(o.k);
  out->set_lookup(wireOf<pb::Lookup>(o.lookup));
  out->set_max_error(o.maxError);
  out->set_visibility(wireOf<pb::Visibility>(o.visibility));
  out->set_bounces(o.bounces);
  out->set_gloss(wireOf<pb::Gloss>(o.gloss));
  out->set_haze(o.haze);
  out->set_haze_absorption(o.hazeAbsorption);
  out->set_haze_anisotropy(o.hazeAnisotropy);
}

void toProto(const SessionSummary& in, pb::Session* out) {
  const auto seconds = [](std::chrono::system_clock::time_point t) {
    return std::chrono::duration_cast<std::chrono::seconds>(t.time_since_epoch()).count();
  };
  out->set_name(sessionName(in.id));
  toProto(in.options, out->mutable_settings());
  out->mutable_settings()->mutable_ttl()->set_seconds(in.ttl.count());
  out->mutable_settings()->set_display_name(in.displayName);
  toProto(in.grid, out->mutable_grid());
  out->set_revision(in.revision);
  out->set_epoch(in.epoch);
  out->mutable_create_time()->set_seconds(seconds(in.created));
  if (in.ttl.count() > 0 && in.subscribers == 0) {
    out->mutable_expire_time()->set_seconds(seconds(in.lastUsed + in.ttl));
  }
  out->set_light_count(int(in.lights));
  out->set_surface_count(int(in.surfaces));
  out->set_triangle_count(in.triangles);
  out->set_client_count(int(in.clients));
  out->set_subscriber_count(int(in.subscribers));
  const int cells = std::max({in.grid.dims.x, in.grid.dims.y, in.grid.dims.z});
  out->set_expected_error(in.forecast ? in.forecast->error : expectedError(resolved(in.options), cells));
  if (in.forecast) out->set_choice(in.forecast->choice);
  if (in.measured) {
    out->set_measured_error(in.measured->error);
    out->set_measured_error_low(in.measured->low);
    out->set_measured_error_high(in.measured->high);
    out->set_measured_revision(in.measured->revision);
  }
  if (in.memory) {
    out->mutable_gpu_memory()->set_light_bytes(in.memory->light);
    out->mutable_gpu_memory()->set_frame_bytes(in.memory->frames);
    out->mutable_gpu_memory()->set_scene_bytes(in.memory->scene);
  }
  out->set_durability(toProto(in.durability));
}

pb::Durability toProto(Durability durability) {
  return durability == Durability::kDisk ? pb::DURABILITY_DISK : pb::DURABILITY_MEMORY;
}

// Tokens are kept under these numbers.
static_assert(int(Role::kViewer) == pb::ROLE_VIEWER && int(Role::kEditor) == pb::ROLE_EDITOR &&
              int(Role::kOwner) == pb::ROLE_OWNER);

pb::Role toProto(Role role) {
  switch (role) {
    case Role::kViewer:
      return pb::ROLE_VIEWER;
    case Role::kEditor:
      return pb::ROLE_EDITOR;
    case Role::kOwner:
    case Role::kAdmin:
      return pb::ROLE_OWNER;
  }
  return pb::ROLE_UNSPECIFIED;
}

Expected<Role> roleOf(pb::Role role) {
  switch (role) {
    case pb::ROLE_VIEWER:
      return Role::kViewer;
    case pb::ROLE_EDITOR:
      return Role::kEditor;
    case pb::ROLE_OWNER:
      return Role::kOwner;
    default:
      return invalid("role", "role is " + std::to_string(int(role)) + ", allowed are VIEWER, EDITOR and OWNER");
  }
}

Status checkSequence(const ClientIdentity& client, std::uint64_t sequence) {
  constexpr std::uint64_t kMost = std::numeric_limits<std::int64_t>::max();
  if (client.id.empty() || (sequence >= 1 && sequence <= kMost)) return {};
  return invalid("sequence", "sequence is " + std::to_string(sequence) + ", allowed are 1 to " + std::to_string(kMost) +
                                 " with an identity: count up from 1");
}

ClientIdentity fromProto(const pb::ClientIdentity& identity) { return {identity.client_id(), identity.secret()}; }

}  // namespace lpv::api
