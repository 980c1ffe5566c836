#include "impact_damper/io/json_reader.hpp"

#include <doctest/doctest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>

#include "impact_damper/io/file_output.hpp"
#include "impact_damper/io/json_writer.hpp"

using namespace impact_damper;

namespace {

using Lines = std::vector<std::string>;

// The problems that reading `text` with `read` ends in.
template <typename Read>
Lines problems(const std::string& text, Read read) {
  try {
    JsonDocument document = JsonDocument::parse("f.json", text);
    ObjectReader root = document.root();
    read(root);
    document.finish();
  } catch (const InputError& error) {
    return error.problems();
  }
  return {};
}

Lines problems(const std::string& text) {
  return problems(text, [](ObjectReader& root) { root.keys(); });
}

enum class Colour { red, green };
std::string_view name_of(Colour colour) { return colour == Colour::red ? "red" : "green"; }

}  // namespace

TEST_CASE("every type is read as it was written") {
  JsonDocument document = JsonDocument::parse("f.json", R"({
    "number": -0.0, "whole": -9223372036854775808, "text": "a/b", "flag": true, "colour": "green",
    "numbers": [1, 2.5, 1e300], "maybe": [null, 3], "none": null, "inner": {"x": 1}, "list": [{"x": 2}, {"x": 3}]})");
  ObjectReader root = document.root();
  double number = 1;
  std::int64_t whole = 0;
  std::string text;
  bool flag = false;
  Colour colour = Colour::red;
  std::vector<double> numbers, empty{1};
  std::vector<std::optional<double>> maybe;
  std::optional<double> none = 1, missing = 2;
  root.required("number", number);
  root.required("whole", whole);
  root.required("text", text);
  root.required("flag", flag);
  root.required("colour", colour, {Colour::red, Colour::green});
  root.required("numbers", numbers, above(0));
  root.required("maybe", maybe);
  root.required("none", none);
  root.optional("missing", missing);
  root.optional("empty", empty);
  double x = 0;
  root.required_object("inner").required("x", x);
  CHECK(x == 1);
  for (ObjectReader item : root.required_objects("list", 2)) item.required("x", x, within(2, 3));
  CHECK(x == 3);
  CHECK_NOTHROW(document.finish());
  CHECK(std::signbit(number));
  CHECK(whole == std::numeric_limits<std::int64_t>::min());
  CHECK(text == "a/b");
  CHECK(flag);
  CHECK(colour == Colour::green);
  CHECK(numbers == std::vector<double>{1, 2.5, 1e300});
  CHECK(maybe == std::vector<std::optional<double>>{std::nullopt, 3});
  CHECK(!none);
  CHECK(missing == 2.0);
  CHECK(empty.size() == 1);
}

TEST_CASE("all problems of a file are found in one reading") {
  const Lines found = problems(
      R"({"restitutoin": 0.6, "x": "6", "n": -5, "m": 18446744073709551615, "r": 3.0, "deep": {"a": [1, null]}, "q/~": 1})",
      [](ObjectReader& root) {
        double x = 0, missing = 0;
        std::int64_t n = 0, m = 0, r = 0;
        std::vector<double> a;
        root.optional("restitution", x);
        root.required("x", x, within(0, 1));
        root.required("n", n, at_least(0));
        root.required("m", m);
        root.required("r", r);
        root.required("missing", missing);
        root.required_object("deep").required("a", a);
      });
  CHECK(found == Lines{
                     "f.json: /x: must be a number >= 0 and <= 1, got the string \"6\"",
                     "f.json: /n: must be a whole number >= 0, got -5",
                     "f.json: /m: must be a whole number, got 18446744073709551615",
                     "f.json: /r: must be a whole number, written without point or exponent, got 3.0",
                     "f.json: /missing: missing, a value must be given",
                     "f.json: /deep/a/1: must be a number, got null",
                     "f.json: /q~1~0: unknown key, allowed are: deep, m, missing, n, r, restitution, x",
                     "f.json: /restitutoin: unknown key, did you mean \"restitution\"?",
                 });
}

TEST_CASE("a duplicate key is found wherever it is") {
  CHECK(problems(R"({"a": 1, "b": 2, "a": 1})") ==
        Lines{"f.json: /a: duplicate key, allowed is one value for each key"});
  CHECK(problems(R"({"list": [0, {"a": {}, "a": 2}], "list": 0})") ==
        Lines{"f.json: /list/1/a: duplicate key, allowed is one value for each key",
              "f.json: /list: duplicate key, allowed is one value for each key"});
}

TEST_CASE("a duplicate key is one problem among the others") {
  CHECK(problems(R"({"x": 1, "y": 2, "x": "6"})",
                 [](ObjectReader& root) {
                   double x = 0;
                   root.required("x", x);
                 }) == Lines{"f.json: /x: duplicate key, allowed is one value for each key",
                             "f.json: /x: must be a number, got the string \"6\"",
                             "f.json: /y: unknown key, allowed are: x"});
}

TEST_CASE("a text has one line and a length in characters, a name only what file names may hold") {
  const auto read = [](const std::string& value, TextRule rule) {
    return problems("{\"a\": \"" + value + "\"}", [&](ObjectReader& root) {
      std::string a = "kept";
      const bool is_read = root.required("a", a, rule);
      CHECK(is_read == (a != "kept"));
    });
  };
  CHECK(read("", {}).empty());
  CHECK(read("", some_text) ==
        Lines{"f.json: /a: must be a text of one line and 1 to 4000 characters, got the string \"\""});
  CHECK(read("\xce\xbd\xce\xb6", {2, 2}).empty());
  CHECK(read("abc", {0, 2}) ==
        Lines{"f.json: /a: must be a text of one line and up to 2 characters, got the string \"abc\""});
  CHECK(read("one\\ntwo", {}).size() == 1);
  CHECK(read("a\\u0000b", {}).size() == 1);
  CHECK(read("\\u007f", {}).size() == 1);
  CHECK(read("nu2-e06_b.c", a_name).empty());
  for (const char* name : {"", ".hidden", "-o", "a/b", "../a", "a b", "\xc3\xa9", "a\\n"}) {
    CAPTURE(name);
    CHECK(read(name, a_name).size() == 1);
  }
  CHECK(read(std::string(64, 'a'), a_name).empty());
  CHECK(read(std::string(65, 'a'), a_name).size() == 1);
}

TEST_CASE("an array is no longer than allowed, its texts no two alike") {
  const auto texts = [](const std::string& array) {
    return problems("{\"a\": " + array + "}", [](ObjectReader& root) {
      std::vector<std::string> a;
      root.required("a", a, a_name, std::size_t{2});
    });
  };
  CHECK(texts(R"(["b", "c"])").empty());
  CHECK(texts(R"(["b", "c", "d"])") == Lines{"f.json: /a: must have at most 2 elements, got 3"});
  CHECK(texts(R"(["b", "b"])") ==
        Lines{"f.json: /a/1: must differ from those before it, got the string \"b\""});
  CHECK(problems(R"({"a": [{}, {}, {}]})", [](ObjectReader& root) {
          CHECK(root.required_objects("a", 2).empty());
        }) == Lines{"f.json: /a: must have at most 2 elements, got 3"});
  for (const std::size_t least : {1, 2}) {
    CHECK(problems(R"({"a": []})",
                   [&](ObjectReader& root) { CHECK(root.required_objects("a", 2, least).empty()); }) ==
          Lines{"f.json: /a: must have at least " + std::string(least == 1 ? "1 element" : "2 elements") +
                ", got 0"});
  }
}

TEST_CASE("a field within a list is named by its pointer") {
  CHECK(problems(R"({"a": {"list": [{}, {"b": 1}]}})", [](ObjectReader& root) {
          ObjectReader a = root.required_object("a");
          for (ObjectReader each : a.required_objects("list", 2)) each.has("b");
          a.reject(Problem{"list[1].b", "is wrong"});
          a.reject(Problem{"", "is wrong, too"});
        }) == Lines{"f.json: /a/list/1/b: is wrong", "f.json: /a: is wrong, too"});
}

TEST_CASE("what takes far more memory than its text is rejected while it is read") {
  std::string objects = "{\"a\": [{}", values = "{\"a\": [0";
  for (int i = 1; i < 100'000; ++i) objects += ",{}";
  for (int i = 1; i < 10'000'000; ++i) values += ",0";
  CHECK(problems(objects + "]}") ==
        Lines{"f.json: too many objects, arrays, keys and texts, allowed are 100000"});
  CHECK(problems(values + ",0]}") == Lines{"f.json: too many values, allowed are 10000000"});
}

TEST_CASE("what is not JSON is rejected with line and column") {
  const auto only = [](const std::string& text) {
    const Lines found = problems(text);
    REQUIRE(found.size() == 1);
    return found[0];
  };
  // What stands behind the place is the library's, and differs by its version.
  CHECK(only("{\n  \"a\": nan}").starts_with("f.json: line 2, column 9: "));
  CHECK(only("{} {}").starts_with("f.json: line 1, column 4: "));
  CHECK(only("{\"a\": 1e999}").starts_with("f.json: line 1, column 11: "));
  CHECK(only("{\"a\": 1,}").starts_with("f.json: line 1, column 9: "));
  CHECK(only("{\"a\": -}").starts_with("f.json: line 1, column 8: "));
  for (const char* nothing : {"", " ", "\r\n\t\n"}) CHECK(only(nothing) == "f.json: is empty, must be JSON");
  CHECK(only("{\"a\": \"\n\"}").find('\n') == std::string::npos);
  CHECK(only("[1]") == "f.json: must be an object, got an array");
}

TEST_CASE("nesting is allowed to 64 levels and rejected beyond, however deep") {
  const auto nested = [](std::size_t levels) {
    return "{\"a\":" + std::string(levels - 1, '[') + std::string(levels - 1, ']') + "}";
  };
  CHECK(problems(nested(64)).empty());
  const Lines rejected{"f.json: nested too deeply, allowed are 64 levels"};
  CHECK(problems(nested(65)) == rejected);
  CHECK(problems("{\"a\":" + std::string(1'000'000, '[')) == rejected);
}

TEST_CASE("a million wrong numbers make a short report") {
  std::string text = "{\"a\": [null";
  for (int i = 1; i < 1000; ++i) text += ",null";
  const Lines found = problems(text + "]}", [](ObjectReader& root) {
    std::vector<double> a;
    root.required("a", a);
    CHECK(a.empty());
  });
  CHECK(found.size() == 51);
  CHECK(found.back() == "f.json: and 950 more problems");
}

TEST_CASE("the word that was meant is named only if it is near") {
  const std::vector<std::string_view> known{"mass_ratio", "restitution", "x0"};
  CHECK(nearest("mas_ratio", known) == "mass_ratio");
  CHECK(nearest("mass-ratio", known) == "mass_ratio");
  CHECK(nearest("x1", known) == "x0");
  CHECK(!nearest("omega", known));
  // Broken off, and by fewer letters from another name.
  CHECK(nearest("exciting_freq", {"exciting_force", "exciting_frequency"}) == "exciting_frequency");
  CHECK(!nearest("q", {"x"}));
  CHECK(!nearest("q1", known));  // no letter of it is right
}

TEST_CASE("a word that ends in a unit never means one with another unit or without one") {
  const std::vector<std::string_view> known{"x_mm", "until_millimetres", "until_seconds", "mass",
                                            "mass_ratio"};
  CHECK(!nearest("x_cm", known));
  CHECK(!nearest("x_m", known));
  CHECK(!nearest("until_centimetres", known));
  CHECK(!nearest("until_milliseconds", known));
  CHECK(!nearest("mass_g", known));
  CHECK(nearest("y_mm", known) == "x_mm");
  CHECK(nearest("until_millimeters", known) == "until_millimetres");
  CHECK(nearest("until_secon", known) == "until_seconds");
}

TEST_CASE("a word that is the last part of several names may mean each of them") {
  const std::vector<std::string_view> known{"exciting_frequency", "mass", "natural_frequency", "x0"};
  CHECK(did_you_mean("frequency", known) == ", did you mean exciting_frequency or natural_frequency?");
  CHECK(did_you_mean("Frequency", known, "'") ==
        ", did you mean 'exciting_frequency' or 'natural_frequency'?");
  CHECK(did_you_mean("natural_freqency", known) == ", did you mean natural_frequency?");
  CHECK(did_you_mean("frequency", {"--force-frequency", "--x0"}) == ", did you mean --force-frequency?");
  CHECK(did_you_mean("colour", known) == "");
}

TEST_CASE("options of the command line and keys of plans are known by each other's names") {
  CHECK(did_you_mean("keep", {"grid", "quantities"}) == ", did you mean quantities?");
  CHECK(did_you_mean("vary", {"grid", "quantities"}) == ", did you mean grid?");
  CHECK(did_you_mean("--quantities", {"--vary", "--keep"}) == ", did you mean --keep?");
  CHECK(did_you_mean("--grid", {"--vary", "--keep"}) == ", did you mean --vary?");
}

TEST_CASE("capitals decide which word was meant only between words that are equally near without them") {
  const std::vector<std::string_view> known{"v0", "x0", "y0", "mass_ratio", "restitution"};
  CHECK(nearest("X0", known) == "x0");
  CHECK(nearest("Y0", known) == "y0");
  CHECK(nearest("X", known) == "x0");
  CHECK(nearest("MASS-RATIO", known) == "mass_ratio");
  CHECK(nearest("Restitutoin", known) == "restitution");
  CHECK(nearest("RESTI", known) == "restitution");
  CHECK(nearest("RATIO", known) == "mass_ratio");
  CHECK(nearest("Ab", {"ab", "AB", "Abc"}) == "ab");
  CHECK(nearest("aB", {"Ab", "aBc", "ab"}) == "ab");
  CHECK(nearest("Q0", {"q0", "Q0"}) == "Q0");
}

TEST_CASE("a limit of integers is exact, also where a double would round") {
  const double limit = 0x1p53;
  const auto read = [](const std::string& number, NumberRange range) {
    std::int64_t value = 7;
    return problems("{\"a\": " + number + "}", [&](ObjectReader& root) { root.required("a", value, range); })
        .empty();
  };
  CHECK(read("9007199254740992", within(0, limit)));
  CHECK(!read("9007199254740993", within(0, limit)));
  CHECK(read("-9007199254740992", within(-limit, 0)));
  CHECK(!read("-9007199254740993", within(-limit, 0)));
  CHECK(!read("9007199254740992", above(limit)));
  CHECK(read("9007199254740993", above(limit)));
  CHECK(read("9223372036854775807", NumberRange{}));
  CHECK(read("9223372036854775807", within(0, 0x1p63)));
  CHECK(!read("9223372036854775807", within(0, 9223372036854774784.0)));  // the double below 2^63
  CHECK(read("-9223372036854775808", within(-0x1p63, 0)));
}

TEST_CASE("a symbol, or a part of a name, leads to the name") {
  const std::vector<std::string_view> options{
      "--x0", "--mass-ratio", "--force-amplitude", "--force-frequency", "--restitution", "--until-time"};
  CHECK(nearest("--nu", options) == "--mass-ratio");
  CHECK(nearest("-e", options) == "--restitution");
  CHECK(nearest("--f0", options) == "--force-amplitude");
  CHECK(nearest("--omega", options) == "--force-frequency");
  CHECK(nearest("--until", options) == "--until-time");
  CHECK(nearest("--fr", options) == std::nullopt);  // too short for a part
  const std::vector<std::string_view> keys{
      "mass", "secondary_mass", "exciting_force", "exciting_frequency", "contact_stiffness", "clearance"};
  CHECK(nearest("force", keys) == "exciting_force");
  CHECK(nearest("frequency", keys) == "exciting_frequency");
  CHECK(nearest("m", keys) == "secondary_mass");
  CHECK(nearest("M", keys) == "mass");
  CHECK(nearest("k", keys) == "contact_stiffness");
  CHECK(nearest("orce", keys) == std::nullopt);  // begins no part, and is near none
}

TEST_CASE("whatever stands in a file, a message is one line of UTF-8") {
  CHECK(cut("a\nb\x1b\x7f") == "a?b??");
  CHECK(cut("\xce\xbd\xe2\x82\xac", 1) == "\xce\xbd...");
  CHECK(cut("\xce\xbd\xe2\x82\xac", 2) == "\xce\xbd\xe2\x82\xac");
  CHECK(cut("caf\xe9, \x80\xff\xf0\x9f") == "caf?, ????");
}

TEST_CASE("a missing object is one problem, not one for each of its fields") {
  CHECK(
      problems("{\"a\": 3}", [](ObjectReader& root) {
        double x = 0;
        root.required_object("scene").required("x", x);
        root.required_object("a").required("x", x);
      }) == Lines{"f.json: /scene: missing, a value must be given", "f.json: /a: must be an object, got 3"});
}

TEST_CASE("what cannot be read is said to be so") {
  const FileKind kind{"thing", 10};
  CHECK_THROWS_AS(JsonDocument::read("no such file.json", kind), IoError);
  CHECK_THROWS_WITH_AS(JsonDocument::read(std::filesystem::temp_directory_path(), kind),
                       doctest::Contains("is a directory"), IoError);
}

TEST_CASE("a file may have just the length that is allowed, and not a byte more") {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("impact-damper-length-test-" + std::to_string(::getpid()));
  write_file(file, "12345");
  CHECK(read_text(file, {"thing", 5}) == "12345");
  CHECK_THROWS_WITH_AS(read_text(file, {"thing", 4}),
                       doctest::Contains("too long, allowed are 4 bytes for a thing, got 5"), InputError);
  std::filesystem::remove(file);
}

TEST_CASE("what is written reads back, on the lines that were asked for") {
  using Layout = JsonWriter::Layout;
  JsonWriter out("thing");
  out.open_object(Layout::lines);
  out.fields("x", -0.0, "n", std::int64_t{-7}, "on", true, "none", std::optional<double>());
  out.field("text", "a \"word\" \\ ν");
  out.object("object", Layout::one_line, "column", std::vector<double>{1, 0.1 + 0.2}, "names",
             std::vector<std::string>{"a", "b"});
  out.open_array("list", Layout::lines);
  for (const double each : {1.0, 2.0}) {
    out.open_object(Layout::one_line);
    out.field("a", each);
    out.new_line();
    out.field("b", std::vector<double>());
    out.close();
  }
  out.close();
  out.close();
  const std::string text = out.finish();
  CHECK(text == R"({
 "x": -0.0,
 "n": -7,
 "on": true,
 "none": null,
 "text": "a \"word\" \\ ν",
 "object": {"column": [1,0.30000000000000004], "names": ["a", "b"]},
 "list": [
  {"a": 1,
   "b": []},
  {"a": 2,
   "b": []}
 ]
})");
  CHECK(problems(text, [](ObjectReader& root) {
          std::string word;
          std::vector<double> column;
          root.keys();
          ObjectReader object = root.required_object("object");
          object.required("column", column, NumberRange{});
          object.keys();
          root.required("text", word);
          for (ObjectReader each : root.required_objects("list", 2)) each.keys();
          CHECK(word == "a \"word\" \\ ν");
          CHECK(column == std::vector<double>{1, 0.1 + 0.2});
        }).empty());
  for (const double value : {std::nan(""), double(INFINITY)}) {
    JsonWriter writer("thing");
    writer.open_object(Layout::lines);
    CHECK_THROWS_WITH_AS(writer.field("x", value),
                         doctest::Contains("a number in \"x\" of the thing is not finite: "), NumericalError);
  }
}
