// What    A WebSocket of the page: lets nobody in who doesn't know the token, hands on what the page says,
//         and sends it what it is to see.
// Shape   The first message is hello, with the token where no cookie has told it. What is sent waits in a
//         queue, one write at a time; a client that doesn't read is left as soon as that is full.
#pragma once

#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/string_body.hpp>

#include "apps/view/house.h"

namespace kdray::view {

void open_socket(boost::beast::tcp_stream&& stream,
                 boost::beast::http::request<boost::beast::http::string_body>&& request, bool knows_token,
                 House& house);

}  // namespace kdray::view
