#pragma once

#include <algorithm>
#include <string>

#include "base/status.h"

namespace lpv::api {

inline constexpr int kDefaultPageSize = 100;
inline constexpr int kMaxPageSize = 1000;

/// One page of `items`, which are in order of `key`. The token is the last key given out, so a page never repeats or
/// skips what stays while others come and go.
template <typename Request, typename Items, typename Key, typename Add>
Status page(const Request& request, const Items& items, Key key, Add add, std::string* nextToken) {
  if (request.page_size() < 0 || request.page_size() > kMaxPageSize) {
    return invalid("page_size",
                   "page_size is " + std::to_string(request.page_size()) + ", allowed are 0 (100) to 1000");
  }
  const int size = request.page_size() == 0 ? kDefaultPageSize : request.page_size();
  auto it = items.begin();
  if (!request.page_token().empty()) {
    it = std::find_if(items.begin(), items.end(), [&](const auto& item) { return key(item) > request.page_token(); });
  }
  std::string last;
  for (int i = 0; i < size && it != items.end(); ++i, ++it) {
    last = key(*it);
    add(*it);
  }
  if (it != items.end()) *nextToken = last;
  return {};
}

}  // namespace lpv::api
