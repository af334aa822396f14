#include <array>
#include <cstring>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/puppet/puppet_edit.hpp>

#include "served.hpp"
#include "web/server.hpp"

namespace server_test {

using namespace nendo;
using namespace nendo::web;
using nendo::test::client_frame;
using nendo::test::eventually;
using nendo::test::FollowingClient;
using nendo::test::open_server;
using nendo::test::Served;
using nendo::test::StreamedLoop;
using nendo::test::Viewer;
using nendo::test::WebClient;

TEST_SUITE("server") {
  TEST_CASE("the page is one whole thing that may run nothing but itself") {
    const auto server = open_server();
    const auto page = WebClient(*server).get("/");
    REQUIRE(page.status == 200);
    CHECK(page.body.find("<canvas") != std::string::npos);
    CHECK(page.body.find("class Shape") != std::string::npos);
    CHECK(page.body.find("vec2 wendland") != std::string::npos);
    for (const auto* outside : {"src=", "@import", "https://", "NENDO-NONCE", "embed "}) {
      CAPTURE(outside);
      CHECK(page.body.find(outside) == std::string::npos);
    }
    CHECK(page.head.find("default-src 'none'; script-src 'nonce-") != std::string::npos);
    CHECK(page.head.find("frame-ancestors 'none'") != std::string::npos);
    CHECK(page.head.find("unsafe") == std::string::npos);
    const auto at = page.head.find("'nonce-") + 7;
    const std::string nonce = page.head.substr(at, page.head.find('\'', at) - at);
    CHECK(nonce.size() == 32);
    CHECK(page.body.find("<script nonce=\"" + nonce + "\">") != std::string::npos);
    CHECK(WebClient(*server).get("/").head != page.head); // another nonce each time
    CHECK(page.body.find(server->token()) == std::string::npos);
    CHECK(server->url() == "http://" + server->endpoint().authority() + "/#" + server->token());
  }

  TEST_CASE("a client gets the forms of a run at once, and after each change, until it has ended") {
    using web::FormKind;
    Served served(flow::Mode::type1);
    served.begin();
    served.server->set_form(FormKind::run, R"({"parts":[]})");
    served.server->set_form(FormKind::status, R"({"parts":[1]})");
    Viewer viewer(served);
    CHECK(viewer.follow_until([&] { return viewer.updates > 0 && viewer.forms[2].is_object(); }));
    CHECK(viewer.held);
    CHECK(viewer.forms[0].is_null());
    CHECK(viewer.forms[1]["parts"].empty());
    const std::string second = R"({"parts":[2]})";
    served.server->set_form(FormKind::run, second);
    CHECK(viewer.follow_until([&] { return viewer.forms[1].dump() == second; }));
    CHECK(viewer.forms[2]["parts"][0] == 1);
    Viewer late(served);
    CHECK(late.follow_until([&] { return late.forms[1].dump() == second; }));
    served.server->present_nothing();
    WebClient client(*served.server);
    REQUIRE(client.open_socket() == 101);
    served.server->set_form(FormKind::screen, "{}");
    const auto form = client.next();
    REQUIRE(form);
    CHECK(form->payload[0] == std::byte{12});
    CHECK(form->payload[1] == std::byte{0}); // and not one of the run before
  }

  TEST_CASE("the input of each form is its own, and the status bar's is none") {
    using web::FormKind;
    const auto server = open_server();
    server->present_nothing();
    WebClient client(*server);
    REQUIRE(client.open_socket() == 101);
    server->set_form(FormKind::screen, "{}");
    client.send_text("panel\tbefore\t"); // there is no panel yet
    client.send_text("form\tStart\t");
    REQUIRE(eventually([&] { return server->next_input(FormKind::screen).has_value(); }));
    server->set_form(FormKind::run, "{}");
    client.send_text("panel\tradius\t12");
    client.send_text("form\tPull\t");
    std::optional<web::FormInput> of_screen;
    REQUIRE(
        eventually([&] { return (of_screen = server->next_input(FormKind::screen)).has_value(); }));
    CHECK(of_screen->control == "Pull");
    const auto of_run = server->next_input(FormKind::run);
    REQUIRE(of_run);
    CHECK(of_run->control == "radius");
    CHECK(of_run->value == "12");
    CHECK_FALSE(server->next_input(FormKind::run));
    CHECK_FALSE(server->next_input(FormKind::status));
    client.send_text("panel\tradius\t13");
    client.send_text("form\tPull\t");
    REQUIRE(eventually([&] { return server->next_input(FormKind::screen).has_value(); }));
    server->present_nothing();
    CHECK_FALSE(server->next_input(FormKind::run)); // it was for the run before
  }

  TEST_CASE("a wrong origin, host or token is refused, and there is nothing before a loop begins") {
    const auto server = open_server();
    const auto status = [&](const std::string& path, const std::string& headers = {},
                            const std::string& host = {}) {
      return WebClient(*server).get(path, headers, host).status;
    };
    const std::string model = WebClient(*server).with_token("/model");
    CHECK(status(model) == 503);
    const StreamedLoop streamed(flow::Mode::type1);
    server->present(streamed.stream, streamed.model);
    CHECK(eventually([&] { return status(model) == 200; }));
    CHECK(status("/model") == 403);
    CHECK(status("/model?token=00000000000000000000000000000000") == 403);
    CHECK(status(model, "Origin: http://evil.example\r\n") == 403);
    CHECK(status(model, {}, "evil.example:80") == 403);
    CHECK(status("/", {}, "evil.example:80") == 403);
    CHECK(status("/favicon.ico") == 404);
    CHECK(WebClient(*server).open_socket("Origin: http://evil.example\r\n") == 403);
    WebClient post(*server);
    post.send("POST / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n");
    const auto refused = post.answer();
    CHECK(refused.status == 405);
    CHECK(refused.head.find("\r\nAllow: GET\r\n") != std::string::npos);
    const auto opened = WebClient(*server).get("/open");
    CHECK(opened.status == 405);
    CHECK(opened.head.find("\r\nAllow: POST\r\n") != std::string::npos);
    WebClient noise(*server);
    noise.send("\x16\x03\x01\x02\r\n\r\n"); // the begin of TLS
    CHECK(noise.answer().status == 400);
    CHECK(server->counters().refused >= 9);
  }

  TEST_CASE("who sends no more after its request is answered, and is not waited for") {
    ServerLimits limits;
    limits.request_timeout = std::chrono::hours(1);
    const auto server = open_server(limits);
    const std::string request = "GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n";
    const auto page = WebClient(*server).get("/");
    for (const int receive_bytes : {0, 2048}) {
      WebClient client(*server, receive_bytes);
      client.send(request);
      client.end_sending();
      const auto answer = client.answer();
      CHECK(answer.status == 200);
      CHECK(answer.body.size() == page.body.size());
      CHECK(client.is_closed());
    }
    WebClient half(*server);
    half.send(request.substr(0, request.size() - 2));
    half.end_sending();
    CHECK(half.is_closed());
    const StreamedLoop streamed(flow::Mode::type1);
    server->present(streamed.stream, streamed.model);
    WebClient socket(*server); // a WebSocket needs both ways
    socket.send("GET " + socket.with_token("/ws") +
                " HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
                "Origin: http://127.0.0.1\r\n\r\n");
    socket.end_sending();
    CHECK(socket.is_closed());
    // The socket ends before the server's turn, at whose end it counts who is still there.
    CHECK(eventually([&] { return server->counters().clients == 0; }));
    CHECK(server->counters().dropped == 0);
  }

  TEST_CASE("a second server at the same port fails with an error that says what to do") {
    const auto server = open_server();
    const auto second = Server::open(server->endpoint());
    REQUIRE_FALSE(second);
    CHECK(second.error().message.find("choose another port") != std::string::npos);
    CHECK_FALSE(Server::open({"192.0.2.1", 0})); // no machine's own
  }

  TEST_CASE("commands reach the loop, and every other message closes the connection") {
    Served served(flow::Mode::type1);
    served.begin();
    Viewer viewer(served);
    CHECK(viewer.client.accept);
    CHECK(viewer.follow_until([&] { return viewer.follows() && viewer.held; }));
    viewer.client.send_text("let go");
    CHECK(viewer.follow_until([&] { return !viewer.held; }));
    CHECK(viewer.rest_changes == 1);
    viewer.client.send_text("grab");
    CHECK(viewer.follow_until([&] { return viewer.held; }));
    viewer.client.send_text("commit");
    CHECK(viewer.follow_until([&] { return viewer.rest_changes == 2; }));
    viewer.client.send_text("undo");
    CHECK(viewer.follow_until([&] { return viewer.jumps == 1; }));
    viewer.client.send(client_frame(0x89, "")); // ping
    bool answered = false;
    while (!answered) {
      const auto frame = viewer.client.next();
      REQUIRE(frame);
      answered = frame->opcode == 10;
    }
    viewer.client.send_text("format the disk");
    CHECK(viewer.client.close_code() == 1008);
    CHECK(viewer.client.is_closed());
  }

  TEST_CASE("a client whose setting is refused is closed with the setting's name and the remedy") {
    const auto server = open_server();
    const StreamedLoop streamed(flow::Mode::type1);
    server->present(streamed.stream, streamed.model);
    WebClient client(*server);
    REQUIRE(eventually([&] { return client.open_socket() == 101; }));
    client.send_text("settings keep_volume=0.5 hold=fist");
    const auto frame = client.next();
    REQUIRE(frame);
    REQUIRE(frame->opcode == 8);
    const std::string reason(reinterpret_cast<const char*>(frame->payload.data()) + 2,
                             frame->payload.size() - 2);
    CHECK(reason == "hold: use tips or hand");
    CHECK_FALSE(server->next_command());
  }

  TEST_CASE("what clients ask for comes out of the server, in its order") {
    const auto server = open_server();
    const StreamedLoop streamed(flow::Mode::type1);
    server->present(streamed.stream, streamed.model);
    WebClient client(*server);
    REQUIRE(eventually([&] { return client.open_socket() == 101; }));
    const std::string settings = "mode=type2 radius_m=0.1,0.1,0.1,0.1,0.2";
    client.send_text("settings " + settings);
    client.send_text("record");
    client.send_text("wrist left 1 2 3 0 0 0 1");
    client.send_text("wrist right 0 0 0 0 0 0 1");
    client.send_text("reset");
    std::vector<web::ClientCommand> commands;
    CHECK(eventually([&] {
      while (const auto command = server->next_command())
        commands.push_back(*command);
      return commands.size() == 5;
    }));
    const std::vector<web::ClientCommand> asked{
        *parse_named_settings(settings), flow::Command(flow::SetRecording{true}),
        flow::Command(flow::WristMove{Side::left, {1, 2, 3}}),
        flow::Command(flow::WristMove{Side::right}), commands::named("reset")};
    CHECK(commands == asked);
    CHECK_FALSE(server->next_command());
  }

  TEST_CASE("a server with a form takes its input, and files one at a time") {
    const auto server = open_server();
    const auto post = [&](const std::string& name, const std::string& bytes) {
      WebClient client(*server);
      client.send("POST " + client.with_token("/open") + "&name=" + name +
                  " HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: " +
                  std::to_string(bytes.size()) + "\r\n\r\n" + bytes);
      return client.answer().status;
    };
    server->present_nothing();
    CHECK(post("a.obj", "v 0 0 0") == 404); // this server has no form
    server->set_form(web::FormKind::screen, "{}");
    CHECK(post("..%2Fa.obj", "v 0 0 0") == 400);
    const std::string large(3'000'000, 'v');
    REQUIRE(post("my%20scan.obj", large) == 200);
    CHECK(post("b.obj", "") == 503);
    const auto file = server->take_file();
    REQUIRE(file);
    CHECK(file->name == "my scan.obj");
    CHECK(file->bytes == large);
    CHECK_FALSE(server->take_file());
    WebClient client(*server);
    REQUIRE(client.open_socket() == 101);
    const auto form = client.next();
    REQUIRE(form);
    CHECK(form->payload[0] == std::byte{12});
    client.send_text("form\tPull\t");
    REQUIRE(eventually([&] {
      const auto input = server->next_input(web::FormKind::screen);
      return input && input->control == "Pull";
    }));
    client.send_text("form\tPull");
    REQUIRE(eventually([&] { return server->next_input(web::FormKind::screen).has_value(); }));
    client.send_text("form Pull");
    CHECK(client.close_code() == 1008);
  }

  TEST_CASE("a file is no longer than its request says") {
    const auto server = open_server();
    server->set_form(web::FormKind::screen, "{}");
    WebClient client(*server);
    client.send("POST " + client.with_token("/open") +
                "&name=a.obj HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 3\r\n\r\nv 0 0 0");
    CHECK(client.answer().status == 200);
    const auto file = server->take_file();
    REQUIRE(file);
    CHECK(file->bytes == "v 0");
  }

  TEST_CASE("of the values of a slider, the last one is not lost, and no click between them") {
    const auto server = open_server();
    server->present_nothing();
    server->set_form(web::FormKind::screen, "{}");
    WebClient client(*server);
    REQUIRE(client.open_socket() == 101);
    for (int value = 0; value < 200; ++value)
      client.send_text("form\ttime\t" + std::to_string(value));
    client.send_text("form\tPlay\t");
    client.send_text("form\tPlay\t");
    client.send_text("form\ttime\tend");
    std::vector<std::string> given;
    REQUIRE(eventually([&] {
      while (const auto input = server->next_input(web::FormKind::screen))
        given.push_back(input->control + input->value);
      return !given.empty() && given.back() == "timeend";
    }));
    REQUIRE(given.size() >= 4);
    CHECK(std::vector(given.end() - 4, given.end()) ==
          std::vector<std::string>{"time199", "Play", "Play", "timeend"});
  }

  TEST_CASE("moves of the pointer become one, and its presses and releases stay in their order") {
    using Event = web::PointerInput::Event;
    const auto server = open_server();
    server->present_nothing();
    server->set_form(web::FormKind::screen, "{}");
    WebClient client(*server);
    REQUIRE(client.open_socket() == 101);
    const auto send = [&](const std::string& event, int many = 1) {
      for (int x = 1; x <= many; ++x)
        client.send_text("form\tkeys\t" + event + '\t' + std::to_string(x) + " 2 0.5 1 0");
    };
    send("move", 50);
    send("down");
    send("drag", 50);
    send("up");
    send("down");
    send("up");
    send("leave");
    std::vector<web::PointerInput> given;
    REQUIRE(eventually([&] {
      while (const auto input = server->next_input(web::FormKind::screen)) {
        REQUIRE(input->pointer);
        given.push_back(*input->pointer);
      }
      return !given.empty() && given.back().event == Event::leave;
    }));
    std::vector<Event> presses;
    double panned = 0.0, wheel = 0.0, last_drag = 0.0;
    for (const web::PointerInput& one : given) {
      if (one.event != Event::move && one.event != Event::drag) presses.push_back(one.event);
      if (one.event == Event::drag) last_drag = one.x;
      panned += one.panned;
      wheel += one.wheel;
    }
    CHECK(presses == std::vector{Event::down, Event::up, Event::down, Event::up, Event::leave});
    CHECK(last_drag == 50.0);
    CHECK(panned == 0.5 * 105);
    CHECK(wheel == 105.0);
  }

  TEST_CASE("clients of a run get nothing about the puppet of the run before") {
    const auto server = open_server();
    const auto puppet_message = [&] {
      WebClient client(*server);
      REQUIRE(client.open_socket() == 101);
      while (const auto message = client.next())
        if (message->payload[0] == std::byte{7}) return message->payload;
      return std::vector<std::byte>();
    };
    const std::array stroke{Eigen::Vector3d(1.0, 2.0, 3.0)};
    const puppet::Rig nothing(puppet::Puppet{}, deform::Points(3, 0));
    const auto masks = puppet::with_masks(nothing, stroke, 0.5);
    REQUIRE(masks);
    const puppet::Rig rig(*masks, deform::Points(3, 0));
    const flow::Frame first; // of each run
    server->present_nothing();
    server->follow(first, &rig);
    CHECK(puppet_message().size() == 8 + 4 + 16);
    server->present_nothing();
    server->follow(first, nullptr);
    CHECK(puppet_message().size() == 8 + 4);
  }

  TEST_CASE("the pictures of forms are there whatever is presented, until others replace them") {
    const auto server = open_server();
    const auto picture = std::make_shared<const std::string>("\x89PNG");
    const auto status = [&](std::size_t number) {
      WebClient client(*server);
      return client.get(client.with_token("/picture") + "&number=" + std::to_string(number)).status;
    };
    const deform::Mesh nothing;
    const deform::BlockLayout layout(nothing.vertices);
    server->present_nothing();
    server->present_beside(std::make_shared<FrameStream>(layout, flow::FrameCapacity{}),
                           model_message(layout, nothing, {}, {}), {picture});
    server->set_pictures({{first_form_picture, picture}});
    CHECK(status(0) == 200);
    CHECK(status(first_form_picture) == 200);
    server->end_beside();
    CHECK(status(0) == 404);
    CHECK(status(first_form_picture) == 200);
    server->set_pictures({{first_form_picture + 1, picture}});
    server->present_nothing();
    CHECK(status(first_form_picture) == 404);
    CHECK(status(first_form_picture + 1) == 200);
    CHECK(status(2'000'000'000) == 404);
  }

  TEST_CASE("clients follow what is shown beside the loop, and then the loop again") {
    Served served(flow::Mode::type1);
    served.begin();
    const auto vertices_of_model = [&] {
      WebClient client(*served.server);
      const std::string model = client.get(client.with_token("/model")).body;
      std::uint32_t vertices = 0;
      if (model.size() > 16) std::memcpy(&vertices, model.data() + 12, sizeof vertices);
      return vertices;
    };
    Viewer viewer(served);
    CHECK(viewer.follow_until([&] { return viewer.follows(); }));
    const auto vertices = vertices_of_model();
    const deform::Mesh nothing;
    const deform::BlockLayout layout(nothing.vertices);
    served.server->present_beside(std::make_shared<FrameStream>(layout, flow::FrameCapacity{}),
                                  model_message(layout, nothing, {}, {}), {});
    CHECK(viewer.client.close_code() == 1012);
    CHECK(vertices_of_model() == 0);
    WebClient beside(*served.server);
    REQUIRE(beside.open_socket() == 101);
    served.server->end_beside();
    CHECK(beside.close_code() == 1012);
    CHECK(vertices_of_model() == vertices);
    Viewer again(served);
    CHECK(again.follow_until([&] { return again.follows() && again.updates > 10; }));
  }

  TEST_CASE("a file that does not come is not waited for") {
    ServerLimits limits;
    limits.request_timeout = std::chrono::milliseconds(200);
    const auto server = open_server(limits);
    server->set_form(web::FormKind::screen, "{}");
    WebClient client(*server);
    client.send("POST " + client.with_token("/open") +
                "&name=a.obj HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 100\r\n\r\nv");
    CHECK(client.is_closed());
    CHECK_FALSE(server->take_file());
  }

  TEST_CASE("also over the network, a follower has the shape that the loop ends with") {
    for (const auto& way : {std::pair<flow::Mode, const char*>{flow::Mode::type1, nullptr},
                            {flow::Mode::type2, nullptr},
                            {flow::Mode::type1, test::ball_puppet},
                            {flow::Mode::type2, test::ball_puppet}}) {
      const flow::Mode mode = way.first;
      const char* const puppet = way.second;
      CAPTURE(name_of(mode));
      CAPTURE((puppet != nullptr));
      auto served = std::make_unique<Served>(mode, ServerLimits{}, puppet);
      served->begin();
      Viewer viewer(*served);
      for (const auto* request : {"commit", "undo", "commit"}) {
        const int updates = viewer.updates + 30;
        CHECK(viewer.follow_until([&] { return viewer.updates > updates; }));
        viewer.client.send_text(request);
      }
      CHECK(viewer.follow_until([&] { return viewer.rest_changes >= 2; }));
      served->end();
      served->streamed.test.loop->frames().update();
      const auto& frame = served->streamed.test.loop->frames().front();
      const auto shape = served->streamed.test.vertices_of(frame);
      CHECK(viewer.follow_until([&] { return viewer.number == frame.ticks_run; }));
      CHECK((viewer.vertices() - shape).cwiseAbs().maxCoeff() < 1e-5 * viewer.diagonal);
      CHECK((shape - served->streamed.test.model.vertices).cwiseAbs().maxCoeff() > 1e-3);
      CHECK(viewer.good);
      const bool weighted = puppet != nullptr; // in both modes along the surface
      CHECK(viewer.weights == (weighted ? 1 : 0));
      CHECK((viewer.vectors > 0) == weighted);
      CHECK(served->server->counters().weights == (weighted ? 1 : 0));
      served->server.reset(); // sends a close frame
      CHECK(viewer.client.close_code() == 1001);
    }
  }

  TEST_CASE("a client with the token gets the model's pictures, with their types, and nothing "
            "else of its folder") {
    const auto server = open_server();
    const auto text = [](const char* contents) {
      return std::make_shared<const std::string>(contents);
    };
    const std::string png = "\x89PNG\r\n\x1A\n...";
    const StreamedLoop streamed(flow::Mode::type1);
    CHECK(WebClient(*server).get(WebClient(*server).with_token("/picture") + "&number=0").status ==
          503);
    server->present(streamed.stream, streamed.model,
                    {text(png.c_str()), nullptr, text("\xFF\xD8\xFF.")});
    const auto get = [&](const std::string& number) {
      WebClient client(*server);
      return client.get(client.with_token("/picture") + "&number=" + number);
    };
    REQUIRE(eventually([&] { return get("0").status == 200; }));
    CHECK(get("0").body == png);
    CHECK(get("0").head.find("Content-Type: image/png\r\n") != std::string::npos);
    CHECK(get("0").head.find("nosniff") != std::string::npos);
    CHECK(get("2").head.find("Content-Type: image/jpeg\r\n") != std::string::npos);
    for (const auto* none : {"1", "3", "999999", "1000000", "18446744073709551616", "-1", "+0",
                             "0x0", "", "0/..", "%30"}) {
      CAPTURE(none);
      CHECK(get(none).status == 404);
    }
    CHECK(WebClient(*server).get("/picture?number=0").status == 403);
    CHECK(WebClient(*server).get("/picture?token=0&number=0").status == 403);
    WebClient client(*server);
    CHECK(client.get(client.with_token("/picture")).status == 404);
  }

  TEST_CASE(
      "another loop closes its clients' connections, and they get its model when they come again") {
    Served served(flow::Mode::type1);
    served.begin();
    Viewer viewer(served);
    CHECK(viewer.follow_until([&] { return viewer.follows(); }));
    const StreamedLoop next(flow::Mode::type2);
    served.server->present(next.stream, next.model);
    CHECK(viewer.client.close_code() == 1012);
    WebClient again(*served.server);
    const auto model = again.get(again.with_token("/model"));
    REQUIRE(model.status == 200);
    const auto bytes = std::as_bytes(std::span(model.body));
    const FollowingClient second({bytes.begin(), bytes.end()});
    CHECK(second.good);
    CHECK(second.loop == 2);
  }

  TEST_CASE(
      "each client gets the settings when it connects, and each change once, before the frames") {
    Served served(flow::Mode::type1);
    flow::LoopSettings settings{.mode = flow::Mode::type2,
                                .kernel = deform::Wendland::c6,
                                .radius_m = {0.1, 0.2, 0.3, 0.4, 0.5}};
    served.server->set_settings(settings);
    served.begin();
    Viewer first(served);
    CHECK(first.follow_until([&] { return first.updates > 0; }));
    CHECK(first.settings_messages == 1);
    CHECK(first.settings.at("mode") == "type2");
    CHECK(first.settings.at("kernel") == "wendland-c6");
    CHECK(first.settings.at("radius_m") == "0.1,0.2,0.3,0.4,0.5");
    served.server->set_settings(settings); // which is nothing new
    const int updates = first.updates + 20;
    CHECK(first.follow_until([&] { return first.updates > updates; }));
    CHECK(first.settings_messages == 1);
    settings.injective = true;
    settings.filter.kind = hand::FilterKind::one_euro;
    served.server->set_settings(settings);
    CHECK(first.follow_until([&] { return first.settings_messages == 2; }));
    CHECK(first.settings.at("injective") == "true");
    CHECK(first.settings.at("filter") == "one-euro");
    Viewer second(served);
    CHECK(second.follow_until([&] { return second.settings_messages == 1; }));
    CHECK(second.settings == first.settings);
  }

  TEST_CASE(
      "each client gets which commands are on, and why others are not possible, when it comes "
      "and at each change") {
    Served served(flow::Mode::type1);
    flow::Frame frame;
    commands::RunFacts facts;
    facts.recorded = true;
    served.server->set_commands({frame, facts});
    served.begin();
    Viewer first(served);
    CHECK(first.follow_until([&] { return first.updates > 0; }));
    CHECK(first.on == std::set<std::string>{"clutch left", "clutch right", "take"});
    CHECK(first.refusals.at("undo") == "There is nothing to undo.");
    CHECK(first.refusals.at("keep") == commands::nothing_kept);
    frame.undo_steps = 1;
    facts = {.keeps_last = true};
    served.server->set_commands({frame, facts});
    CHECK(first.follow_until([&] { return !first.on.contains("take"); }));
    CHECK_FALSE(first.refusals.contains("undo"));
    CHECK_FALSE(first.refusals.contains("keep"));
    Viewer second(served);
    CHECK(second.follow_until([&] { return !second.refusals.empty(); }));
    CHECK(second.on == first.on);
    CHECK(second.refusals == first.refusals);
  }
}

} // namespace server_test
