#pragma once

#include "flotsam/core/types.hpp"

#include <nlohmann/json.hpp>

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace flotsam::scene {

using Json = nlohmann::json;

/// Parses JSON; throws InputError with `name`, line and column. Numbers must be finite, keys must not come twice.
[[nodiscard]] Json parse_strictly(std::string_view text, const std::string& name);

/// Replaces the value at the path of "path=value"; `name` is what the document is called.
void apply_override(Json& document, const std::string& path_and_value, const std::string& name);

/// Of the candidates the one with the smallest edit distance to `word`.
[[nodiscard]] std::string nearest_word(std::string_view word, const std::vector<std::string>& candidates);

/// What a number may be. Nothing in a scene is larger than `most` unless its unit was misread.
struct Allowed {
    enum class Range { any, positive, not_negative } range = Range::any;
    const char* unit = "";
    double least = 0.0; ///< where it is > 0
    double most = 1e9;  ///< in magnitude
};

/// One value of a document and the way to it; reads it strictly, or throws an InputError that names the way.
class JsonNode {
  public:
    JsonNode(const Json& value, std::string name, std::string path)
        : value_(&value), name_(std::move(name)), path_(std::move(path))
    {
    }
    /// Throws InputError "NAME: PATH what".
    [[noreturn]] void refuse(const std::string& what) const;
    /// The same, ending in ", given VALUE".
    [[noreturn]] void refuse_value(const std::string& what) const;

    [[nodiscard]] const Json& json() const { return *value_; }
    [[nodiscard]] const std::string& path() const { return path_; }
    [[nodiscard]] JsonNode child(const std::string& key) const;
    [[nodiscard]] std::vector<JsonNode> entries() const; ///< of a list
    [[nodiscard]] double number(Allowed allowed = {}) const;
    [[nodiscard]] int integer(int at_least, int at_most) const;
    [[nodiscard]] bool boolean() const;
    [[nodiscard]] std::string text() const; ///< not empty
    [[nodiscard]] std::vector<double> numbers(std::initializer_list<std::size_t> lengths, const char* of,
                                              Allowed allowed = {}) const;
    /// Index of the text in `words`.
    [[nodiscard]] std::size_t one_of(std::initializer_list<const char*> words) const;

  private:
    const Json* value_;
    std::string name_;
    std::string path_;
};

/// An object of which all keys are known.
class JsonObject {
  public:
    /// Refuses what is not an object, and any key that is not among `keys`, naming the nearest of them.
    JsonObject(JsonNode node, std::initializer_list<const char*> keys);

    [[nodiscard]] const JsonNode& node() const { return node_; }
    [[nodiscard]] bool has(const char* key) const { return node_.json().contains(key); }
    [[nodiscard]] JsonNode required(const char* key) const;
    [[nodiscard]] std::optional<JsonNode> find(const char* key) const;
    [[nodiscard]] std::vector<JsonNode> list(const char* key) const; ///< empty where the key is missing
    void read(const char* key, double& into, Allowed allowed = {}) const;
    /// Which one of `keys` is there; refuses none and more than one.
    [[nodiscard]] std::string exactly_one(std::initializer_list<const char*> keys) const;

  private:
    JsonNode node_;
};

} // namespace flotsam::scene
