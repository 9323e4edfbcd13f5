#include "grpc/certificates.h"

#include <fcntl.h>
#include <grpcpp/security/tls_certificate_provider.h>
#include <grpcpp/security/tls_credentials_options.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

namespace lpv::grpc_door {
namespace {

namespace fs = std::filesystem;

constexpr unsigned kGrpcLooksEverySeconds = 1;
constexpr const char* kCurrent = "current";
constexpr const char* kFolderPrefix = "lpvd-";

Status noFolder() {
  return {Code::kUnavailable, std::string("no private folder can be made for the certificate: ") +
                                  std::strerror(errno) +
                                  "; set RUNTIME_DIRECTORY or TMPDIR to one that can be written"};
}

/// Holds a folder for as long as this process lives; -1 where another one does.
int lockFolder(const std::string& folder) {
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0 || ::flock(file, LOCK_EX | LOCK_NB) == 0) return file;
  ::close(file);
  return -1;
}

/// Removes what servers that were killed have left. A folder that is just being made has no link yet, and stays.
void removeAbandoned(const std::string& parent) {
  std::error_code failed;
  for (const auto& entry : fs::directory_iterator(parent, failed)) {
    const bool ours = entry.path().filename().string().starts_with(kFolderPrefix);
    if (!ours || !fs::is_symlink(entry.path() / kCurrent, failed)) continue;
    const int file = lockFolder(entry.path());
    if (file < 0) continue;
    fs::remove_all(entry.path(), failed);
    ::close(file);
  }
}

/// A folder of our own for the key: that of the service manager, else in memory, else among temporary files.
Expected<std::string> makePrivateFolder() {
  const char* runtime = std::getenv("RUNTIME_DIRECTORY");
  std::error_code failed;
  for (const std::string& parent : {std::string(runtime == nullptr ? "" : runtime), std::string("/dev/shm"),
                                    fs::temp_directory_path(failed).string()}) {
    if (parent.empty()) continue;
    removeAbandoned(parent);
    std::string name = parent + "/" + kFolderPrefix + "XXXXXX";
    if (mkdtemp(name.data()) != nullptr) return name;
  }
  return noFolder();
}

/// `second` becomes the time of the last change: gRPC tells files apart by whole seconds of it.
bool writeFile(const std::string& path, const std::string& text, std::time_t second) {
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  if (file < 0) return false;
  const bool written = ::write(file, text.data(), text.size()) == ssize_t(text.size());
  const std::array<timespec, 2> times{{{second, 0}, {second, 0}}};
  const bool dated = ::futimens(file, times.data()) == 0;
  return ::close(file) == 0 && written && dated;
}

}  // namespace

/// The folder that gRPC watches: FOLDER/current is a link to the files in use.
class Certificates::Parts {
 public:
  Parts(std::string folder, bool clientsNeedOne)
      : folder_(std::move(folder)), lock_(lockFolder(folder_)), clientsNeedOne_(clientsNeedOne) {}
  ~Parts();

  /// What gRPC is told to read.
  tls::Files published() const;
  Status publish(const tls::PemFiles& good);

 private:
  const std::string folder_;
  const int lock_;
  const bool clientsNeedOne_;
  int number_ = 0;  ///< of the files in use
};

Certificates::Parts::~Parts() {
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
  if (lock_ >= 0) ::close(lock_);
}

tls::Files Certificates::Parts::published() const {
  const std::string current = folder_ + "/" + kCurrent + "/";
  return {current + "certificate", current + "key", clientsNeedOne_ ? current + "authorities" : ""};
}

/// gRPC may be reading the files before these: they stay until the ones after them.
Status Certificates::Parts::publish(const tls::PemFiles& good) {
  const auto place = [this](int number) { return folder_ + "/" + std::to_string(number); };
  const int next = number_ + 1;
  const std::string made = place(next);
  const std::string link = made + ".link";
  std::error_code ignored;
  fs::remove_all(made, ignored);
  const bool kept = ::mkdir(made.c_str(), 0700) == 0 && writeFile(made + "/certificate", good.certificate, next) &&
                    writeFile(made + "/key", good.key, next) &&
                    writeFile(made + "/authorities", good.clientAuthorities, next) &&
                    ::symlink(std::to_string(next).c_str(), link.c_str()) == 0 &&
                    ::rename(link.c_str(), (folder_ + "/" + kCurrent).c_str()) == 0;
  if (!kept) {
    Status failed(Code::kUnavailable, "the certificate cannot be kept in " + folder_ + ": " + std::strerror(errno));
    fs::remove(link, ignored);
    return failed;
  }
  fs::remove_all(place(next - 2), ignored);
  number_ = next;
  return {};
}

Certificates::Certificates(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}
Certificates::~Certificates() = default;

Expected<std::unique_ptr<Certificates>> Certificates::of(tls::Follower& follower) {
  Expected<std::string> folder = makePrivateFolder();
  if (!folder) return folder.status();
  const bool clientsNeedOne = !follower.files().clientAuthorities.empty();
  std::unique_ptr<Certificates> made(new Certificates(std::make_unique<Parts>(std::move(*folder), clientsNeedOne)));
  Expected<std::shared_ptr<void>> following =
      follower.use([&parts = *made->parts_](const tls::PemFiles& good) { return parts.publish(good); });
  if (!following) return following.status();
  made->following_ = std::move(*following);
  return made;
}

std::shared_ptr<grpc::ServerCredentials> Certificates::credentials() const {
  using grpc::experimental::FileWatcherCertificateProvider;
  const tls::Files files = parts_->published();
  grpc::experimental::TlsServerCredentialsOptions options(std::make_shared<FileWatcherCertificateProvider>(
      files.key, files.certificate, files.clientAuthorities, kGrpcLooksEverySeconds));
  options.watch_identity_key_cert_pairs();
  if (files.clientAuthorities.empty()) {
    options.set_cert_request_type(GRPC_SSL_DONT_REQUEST_CLIENT_CERTIFICATE);
  } else {
    options.watch_root_certs();
    options.set_cert_request_type(GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY);
  }
  return grpc::experimental::TlsServerCredentials(options);
}

}  // namespace lpv::grpc_door
