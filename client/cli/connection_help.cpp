#include "connection_help.h"

#include <netdb.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>
#include <sys/socket.h>
#include <unistd.h>

#include <memory>
#include <string>
#include <utility>

namespace lpv::cli {
namespace {

/// An open connection; closed in its destructor.
class Socket {
 public:
  Socket() = default;
  explicit Socket(int number) : number_(number) {}
  Socket(Socket&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Socket& operator=(Socket&&) = delete;
  ~Socket() {
    if (number_ >= 0) ::close(number_);
  }
  int number() const { return number_; }

 private:
  int number_ = -1;
};

struct HostAndPort {
  std::string host;
  std::string port;
};

/// "HOST:PORT" or "[ADDRESS]:PORT".
HostAndPort split(const std::string& address) {
  const std::size_t colon = address.rfind(':');
  if (colon == std::string::npos) return {address, "443"};
  std::string host = address.substr(0, colon);
  if (host.size() > 1 && host.front() == '[' && host.back() == ']') host = host.substr(1, host.size() - 2);
  return {host, address.substr(colon + 1)};
}

/// Connects, with 2 s for every wait from then on. A socket of -1 where nobody answers.
Socket connectTo(const HostAndPort& to) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (getaddrinfo(to.host.c_str(), to.port.c_str(), &hints, &found) != 0) return {};
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> owned(found, &freeaddrinfo);
  for (const addrinfo* each = found; each != nullptr; each = each->ai_next) {
    Socket socket(::socket(each->ai_family, each->ai_socktype | SOCK_CLOEXEC, each->ai_protocol));
    const timeval patience{2, 0};
    setsockopt(socket.number(), SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
    setsockopt(socket.number(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    if (::connect(socket.number(), each->ai_addr, each->ai_addrlen) == 0) return socket;
  }
  return {};
}

/// What a handshake with the server shows.
struct Handshake {
  bool tls = false;           ///< it answered in TLS
  bool wantsClient = false;   ///< it asks for a certificate and was given none
  std::string distrust;       ///< what is wrong with its certificate, in OpenSSL's words
};

/// Trusts what `ca` says; the system's roots for kSystemRoots.
bool loadRoots(SSL_CTX* context, const std::string& ca) {
  if (ca.empty() || ca == kSystemRoots) return SSL_CTX_set_default_verify_paths(context) == 1;
  return SSL_CTX_load_verify_locations(context, ca.c_str(), nullptr) == 1;
}

void expectName(SSL* ssl, const std::string& host) {
  X509_VERIFY_PARAM* check = SSL_get0_param(ssl);
  if (X509_VERIFY_PARAM_set1_ip_asc(check, host.c_str()) == 1) return;
  X509_VERIFY_PARAM_set1_host(check, host.c_str(), host.size());
  SSL_set_tlsext_host_name(ssl, host.c_str());
}

/// The server asks for a certificate, and there is none.
int noteCertificateAsked(SSL* ssl, X509** /*certificate*/, EVP_PKEY** /*key*/) {
  *static_cast<bool*>(SSL_get_app_data(ssl)) = true;
  return 0;
}

/// Whether the server says nothing to a client without certificate. In TLS 1.3 it refuses one after the handshake, and
/// gRPC does so by closing the connection, without an alert; a client that it takes gets its HTTP/2 settings.
bool isRefused(SSL* ssl, bool connected) {
  char byte = 0;
  return !connected || SSL_read(ssl, &byte, 1) <= 0;
}

Handshake handshake(const Socket& socket, const std::string& host, const Globals& globals) {
  Handshake out;
  const std::unique_ptr<SSL_CTX, decltype(&SSL_CTX_free)> context(SSL_CTX_new(TLS_client_method()), &SSL_CTX_free);
  if (!context || !loadRoots(context.get(), globals.ca)) return out;
  SSL_CTX_set_verify(context.get(), SSL_VERIFY_NONE, nullptr);  // the result is looked at, nothing is sent
  if (!globals.cert.empty()) {
    SSL_CTX_use_certificate_chain_file(context.get(), globals.cert.c_str());
    SSL_CTX_use_PrivateKey_file(context.get(), globals.key.c_str(), SSL_FILETYPE_PEM);
  }
  const std::unique_ptr<SSL, decltype(&SSL_free)> ssl(SSL_new(context.get()), &SSL_free);
  constexpr unsigned char kHttp2[] = {2, 'h', '2'};
  SSL_set_alpn_protos(ssl.get(), kHttp2, sizeof kHttp2);
  SSL_set_fd(ssl.get(), socket.number());
  expectName(ssl.get(), host);
  bool asked = false;
  SSL_set_app_data(ssl.get(), &asked);
  SSL_CTX_set_client_cert_cb(context.get(), noteCertificateAsked);
  const bool connected = SSL_connect(ssl.get()) == 1;
  const std::unique_ptr<X509, decltype(&X509_free)> certificate(SSL_get1_peer_certificate(ssl.get()), &X509_free);
  out.tls = certificate != nullptr;
  if (!out.tls) return out;
  const long verified = SSL_get_verify_result(ssl.get());
  if (verified != X509_V_OK) out.distrust = X509_verify_cert_error_string(verified);
  out.wantsClient = globals.cert.empty() && asked && isRefused(ssl.get(), connected);
  return out;
}

std::string helpFor(const Globals& globals) {
  const HostAndPort to = split(globals.server);
  const Socket socket = connectTo(to);
  if (socket.number() < 0) return {};
  const bool secured = !globals.ca.empty() || !globals.cert.empty();
  const Handshake seen = handshake(socket, to.host, globals);
  if (!secured) {
    if (!seen.tls) return {};
    return "the server speaks TLS; give --ca FILE with the certificate of the authority that signed its own, or --ca "
           "system for the authorities that this machine trusts";
  }
  if (!seen.tls) return "the server does not speak TLS; leave --ca, --cert and --key out, or ask for its TLS port";
  if (!seen.distrust.empty()) {
    const bool system = globals.ca.empty() || globals.ca == kSystemRoots;
    return "the server's certificate is not trusted: " + seen.distrust + "; --ca " +
           (system ? "FILE names its authority, if this machine does not know it"
                   : globals.ca + " must hold its authority, and the certificate the name " + to.host);
  }
  if (seen.wantsClient) return "the server asks for a client certificate; give --cert FILE and --key FILE";
  return {};
}

}  // namespace

Status withConnectionHelp(const Status& status, const Globals& globals) {
  const std::string help = helpFor(globals);
  if (help.empty()) return status;
  return Status(status.code(), status.reason(), globals.server + ": " + help, status.field());
}

}  // namespace lpv::cli
