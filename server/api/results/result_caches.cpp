#include "api/results/result_caches.h"

#include "api/call/context.h"

namespace lpv::api {

std::shared_ptr<ResultCaches> makeResultCaches() { return std::make_shared<ResultCaches>(); }

}  // namespace lpv::api
