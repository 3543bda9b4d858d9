// What    A WebSocket of the page: refuses clients that don't know the token, passes the page's messages on
//         to the handler, and sends the page what it is to show.
// Shape   The first message is hello, with the token where no cookie has it. What is sent waits in a queue,
//         one write at a time; a client that doesn't read is disconnected as soon as the queue is full.
#pragma once

#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>

#include "apps/view/server_context.h"

namespace kdray::view {

void open_socket(boost::beast::tcp_stream&& stream,
                 boost::beast::http::request<boost::beast::http::string_body>&& request, bool knows_token,
                 ServerContext& context);

}  // namespace kdray::view
