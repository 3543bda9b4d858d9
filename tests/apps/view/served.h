// What    A server of the page with nobody behind it who renders: it counts who comes, what they say, and who
//         goes.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "apps/view/client.h"
#include "apps/view/server.h"

namespace kdray::test {

class Counter : public view::Reception {
 public:
  void enter(const std::shared_ptr<view::Visitor>& visitor) override {
    const std::lock_guard lock(mutex);
    there[visitor.get()] = visitor;
    ++entered;
    visitor->send(R"({"type":"welcome"})");
  }
  void hear(const view::Visitor& visitor, const view::Message& message) override {
    const std::lock_guard lock(mutex);
    ++heard;
    // A frame for each look, wanted or not, so that there is much to be sent.
    if (std::holds_alternative<view::Look>(message) && !frame.empty())
      there.at(&visitor)->send(view::make_frame("{}", frame));
  }
  void leave(const view::Visitor& visitor) override {
    const std::lock_guard lock(mutex);
    there.erase(&visitor);
  }
  std::size_t n_there() {
    const std::lock_guard lock(mutex);
    return there.size();
  }

  std::mutex mutex;
  std::map<const view::Visitor*, std::shared_ptr<view::Visitor>> there;
  std::atomic<int> entered{0}, heard{0};
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
  // A page that is in.
  std::unique_ptr<Client> enter() {
    auto client = std::make_unique<Client>(port());
    client->upgrade(page());
    client->send(ws_frame(R"({"type":"hello","token":")" + token() + "\"}"));
    EXPECT_NE(client->read_until("welcome").find("welcome"), std::string::npos);
    return client;
  }

  view::Server server;
  Counter counter;  // goes first: it holds visitors
  std::thread thread;
};

inline const std::string kLook =
    R"({"type":"look","number":1,"moving":true,"sight":{"scene":0,"camera":{"from":[1,2,3],"at":[0,0,0],)"
    R"("up":[0,1,0],)"
    R"("fov":40,"ortho":0},"width":64,"height":48,"depth":5,"samples":"adaptive","weight":-1,"headlight":0,)"
    R"("channel":"","mode":"auto","traversal":"auto","queues":0}})";

}  // namespace kdray::test
