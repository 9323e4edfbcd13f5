#pragma once
// Boost's names in short, and the two kinds of connection. Included by door.cpp and what it alone includes.

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/asio/strand.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/ssl.hpp>
#include <chrono>
#include <string_view>

namespace lpv::web_door {

namespace net = boost::asio;
namespace beast = boost::beast;
namespace ssl = net::ssl;
using Tcp = net::ip::tcp;
using Error = boost::system::error_code;
using Plain = beast::tcp_stream;
using Secured = beast::ssl_stream<beast::tcp_stream>;

/// TLS's and WebSocket's.
inline constexpr std::chrono::seconds kHandshakeTime{5};
/// A page that does not answer a close is cut off.
inline constexpr std::chrono::seconds kCloseTime{2};

inline std::string_view viewOf(beast::string_view text) { return {text.data(), text.size()}; }

}  // namespace lpv::web_door
