// What    A server of the page with a handler that renders nothing: it counts clients and their messages.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "apps/view/client.h"
#include "apps/view/facts.h"
#include "apps/view/server.h"

namespace kdray::test {

class Counter : public view::ClientHandler {
 public:
  void connected(const std::shared_ptr<view::Client>& client) override {
    const std::lock_guard lock(mutex);
    clients[client.get()] = client;
    ++n_connected;
    client->send(R"({"type":"welcome"})");
  }
  void received(const view::Client& client, const view::Message& message) override {
    const std::lock_guard lock(mutex);
    ++n_received;
    // A frame for each look, wanted or not, so that there is much to be sent.
    if (std::holds_alternative<view::Look>(message) && !frame.empty())
      clients.at(&client)->send(view::make_frame("{}", frame));
  }
  void disconnected(const view::Client& client) override {
    const std::lock_guard lock(mutex);
    clients.erase(&client);
  }
  std::size_t n_clients() {
    const std::lock_guard lock(mutex);
    return clients.size();
  }

  std::mutex mutex;
  std::map<const view::Client*, std::shared_ptr<view::Client>> clients;
  std::atomic<int> n_connected{0}, n_received{0};
  std::string frame;
};

struct Served : testing::Test {
  explicit Served(const view::Limits& limits = {})
      : server({}, limits), thread([this] { server.run(counter); }) {}
  ~Served() override {
    server.stop();
    thread.join();
  }

  int port() const { return server.port(); }
  std::string token() const {
    const std::string address = server.address();
    return address.substr(address.find("#token=") + 7);
  }
  std::string host() const { return "127.0.0.1:" + std::to_string(port()); }
  Head page() const { return {host(), "http://" + host(), "", ""}; }
  std::string status(const std::string& text) {
    Client client(port());
    client.send(text);
    return client.read_until("\r\n").substr(0, 12);
  }
  // A page whose token was accepted.
  std::unique_ptr<Client> connect() {
    auto client = std::make_unique<Client>(port());
    client->upgrade(page());
    client->send(ws_frame(R"({"type":"hello","token":")" + token() + "\"}"));
    EXPECT_NE(client->read_until("welcome").find("welcome"), std::string::npos);
    return client;
  }

  view::Server server;
  Counter counter;  // ends before the server: it holds clients
  std::thread thread;
};

inline const std::string kLook =
    R"({"type":"look","number":1,"moving":true,"sight":{"scene":0,"camera":{"from":[1,2,3],"at":[0,0,0],)"
    R"("up":[0,1,0],)"
    R"("fov":40,"ortho":0},"width":64,"height":48,"depth":5,"samples":"adaptive","weight":-1,"headlight":0,)"
    R"("channel":"","mode":"auto","traversal":"auto","queues":0}})";

}  // namespace kdray::test
