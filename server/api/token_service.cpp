#include <google/protobuf/util/time_util.h>

#include "api/call/paging.h"
#include "api/services.h"
#include "convert/session.h"

namespace lpv::api {
namespace {

google::protobuf::Timestamp timestamp(std::chrono::system_clock::time_point time) {
  return google::protobuf::util::TimeUtil::SecondsToTimestamp(
      std::chrono::duration_cast<std::chrono::seconds>(time.time_since_epoch()).count());
}

Status tokensAreOff() {
  return {Code::kFailedPrecondition, "this server asks for no access tokens; start lpvd with --admin-token-file"};
}

}  // namespace

void createToken(const Context& context, const pb::CreateTokenRequest& request, pb::CreateTokenResponse* response,
                 Done done) {
  const Expected<SessionPtr> session = findSession(context, "session", request.session());
  if (!session) return done(session.status());
  if (!context.access->required()) return done(tokensAreOff());
  const Expected<Role> role = roleOf(request.role());
  if (!role) return done(role.status());
  std::chrono::seconds life = kDefaultTokenLife;
  if (request.has_ttl()) life = std::chrono::seconds(request.ttl().seconds());
  const Expected<MintedToken> token = context.access->mint((*session)->id(), *role, life);
  if (!token) return done(token.status());
  // A session that went meanwhile has taken its tokens along; this one may have come too late for that.
  const Expected<SessionPtr> still = findSession(context, "session", request.session());
  if (!still || *still != *session) {
    (void)context.access->revoke((*session)->id(), token->kept.id);
    return done(Status(Code::kAborted, "the session went while the token was made; try again", "session"));
  }
  response->set_token(token->token);
  response->set_token_id(token->kept.id);
  *response->mutable_expire_time() = timestamp(token->kept.expires);
  context.registry->whenDurable((*session)->id(), token->position, std::move(done));
}

void revokeToken(const Context& context, const pb::RevokeTokenRequest& request, pb::RevokeTokenResponse*, Done done) {
  const Expected<SessionPtr> session = findSession(context, "session", request.session());
  if (!session) return done(session.status());
  const Expected<Position> gone = context.access->revoke((*session)->id(), request.token_id());
  if (!gone) return done(gone.status());
  context.registry->whenDurable((*session)->id(), *gone, std::move(done));
}

Status listTokens(const Context& context, const pb::ListTokensRequest& request, pb::ListTokensResponse* response) {
  const Expected<SessionPtr> session = findSession(context, "session", request.session());
  if (!session) return session.status();
  if (!context.access->required()) return tokensAreOff();
  return page(
      request, context.access->tokensOf((*session)->id()), [](const AccessToken& token) { return token.id; },
      [&](const AccessToken& token) {
        pb::AccessToken* out = response->add_tokens();
        out->set_token_id(token.id);
        out->set_role(toProto(token.role));
        *out->mutable_expire_time() = timestamp(token.expires);
      },
      response->mutable_next_page_token());
}

}  // namespace lpv::api
