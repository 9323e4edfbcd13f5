#pragma once
// SQLite as this store uses it: one connection, statements that are prepared once, errors as values.

#include <sqlite3.h>

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "base/status.h"

namespace lpv::store {

/// A BLOB argument.
struct Bytes {
  const std::string& value;
};

class Database;

/// A prepared statement in use. step() until it says false; columns count from 0.
class Statement {
 public:
  template <typename... Arguments>
  Statement(Database& database, sqlite3_stmt* statement, const Arguments&... arguments)
      : database_(database), statement_(statement) {
    int index = 0;
    (bind(++index, arguments), ...);
  }
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  /// True where there is a row.
  Expected<bool> step();
  std::int64_t integer(int column) const { return sqlite3_column_int64(statement_, column); }
  /// TEXT or BLOB.
  std::string bytes(int column) const;

 private:
  void bind(int index, const std::string& text);
  void bind(int index, std::int64_t value);
  void bind(int index, const Bytes& bytes);

  Database& database_;
  sqlite3_stmt* statement_;  ///< null where preparing failed: step() says why
  int failure_ = SQLITE_OK;
};

/// Not thread-safe.
class Database {
 public:
  /// Opens or makes `path`. Errors name it.
  static Expected<std::unique_ptr<Database>> open(const std::string& path);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  /// `sql` lives as long as this; one statement.
  template <typename... Arguments>
  Statement query(const char* sql, const Arguments&... arguments) {
    return Statement(*this, prepared(sql), arguments...);
  }
  template <typename... Arguments>
  Status run(const char* sql, const Arguments&... arguments) {
    return query(sql, arguments...).step().status();
  }

  /// The last error: UNAVAILABLE where trying again may help (disk full, I/O), DATA_LOSS for a damaged file.
  Status failure() const;
  const std::string& path() const { return path_; }

 private:
  explicit Database(std::string path) : path_(std::move(path)) {}
  sqlite3_stmt* prepared(const char* sql);

  std::string path_;
  sqlite3* handle_ = nullptr;
  std::map<std::string_view, sqlite3_stmt*> statements_;
};

}  // namespace lpv::store
