#include "kluft/studies/study_schema.hpp"

#include <iterator>
#include <vector>

#include "kluft/studies/study.hpp"

namespace kluft {

namespace {

constexpr Range copies{.least = 1.0, .most = 1000.0};
constexpr std::string_view set_doc = "Keys of the scene, as in --set, and their values in all cases.";
constexpr std::string_view vary_doc = "Keys of the scene and their values: a list; {from, to, count}, equal steps; "
                                      "{from, to, factor}, each value `factor` times "
                                      "the one before, numbers without units.";

std::vector<KeyRule> general_rules() {
    return {
        {.path = "title", .type = KeyType::text, .fallback_note = "the file's name", .doc = "Of the table."},
        {.path = "scene", .type = KeyType::text, .required = true, .doc = "The scene, relative to the study file."},
        {.path = "set", .type = KeyType::named, .doc = set_doc},
        {.path = "set.*", .type = KeyType::value, .doc = "A value, as the scene has it."},
        {.path = "vary", .type = KeyType::named, .doc = vary_doc},
        {.path = "vary.*", .type = KeyType::values_or_mapping, .doc = "Values of a key."},
        {.path = "vary.*.from", .type = KeyType::number, .required = true, .doc = "The first value."},
        {.path = "vary.*.to", .type = KeyType::number, .required = true, .doc = "The last value, or its bound."},
        {.path = "vary.*.count",
         .type = KeyType::integer,
         .range = {.least = 2.0, .most = most_cases},
         .doc = "How many values, in equal steps."},
        {.path = "vary.*.factor", .type = KeyType::number, .doc = "Each value over the one before."},
        {.path = "combine",
         .type = KeyType::choice,
         .choices = {"product", "together"},
         .fallback = "product",
         .doc = "`product`: every combination; `together`: the first values of all keys, the second ones, and so on."},
    };
}

std::vector<KeyRule> variant_rules() {
    return {
        {.path = "variants",
         .type = KeyType::list,
         .doc = "Named groups, each with everything that varies in the study and its own."},
        {.path = "variants.#", .type = KeyType::mapping, .doc = "A group."},
        {.path = "variants.#.name", .type = KeyType::text, .required = true, .doc = "A name of its own."},
        {.path = "variants.#.set", .type = KeyType::named, .doc = set_doc},
        {.path = "variants.#.set.*", .type = KeyType::value, .doc = "A value, as the scene has it."},
        {.path = "variants.#.vary", .type = KeyType::named, .doc = vary_doc},
        {.path = "variants.#.vary.*", .type = KeyType::values_or_mapping, .doc = "Values of a key."},
        {.path = "variants.#.vary.*.from", .type = KeyType::number, .required = true, .doc = "The first value."},
        {.path = "variants.#.vary.*.to",
         .type = KeyType::number,
         .required = true,
         .doc = "The last value, or its bound."},
        {.path = "variants.#.vary.*.count",
         .type = KeyType::integer,
         .range = {.least = 2.0, .most = most_cases},
         .doc = "How many values, in equal steps."},
        {.path = "variants.#.vary.*.factor", .type = KeyType::number, .doc = "Each value over the one before."},
    };
}

std::vector<KeyRule> replica_rules() {
    return {
        {.path = "replicas",
         .type = KeyType::integer_or_mapping,
         .range = copies,
         .doc = "Copies of each case with a small perturbation, a number or a mapping."},
        {.path = "replicas.count",
         .type = KeyType::integer,
         .range = copies,
         .required = true,
         .doc = "How many copies."},
        {.path = "replicas.seed",
         .type = KeyType::integer,
         .range = {.least = 0.0, .most = 9007199254740992.0},
         .fallback = "1",
         .doc = "Another seed gives other copies."},
        {.path = "replicas.strength_noise",
         .type = KeyType::number,
         .range = {.least = 0.0, .most = 1.0},
         .fallback = "1 %",
         .doc = "Relative standard deviation of the potential cracks' strengths."},
        {.path = "replicas.offset",
         .type = KeyType::boolean,
         .fallback = "false",
         .doc = "Moves the net of hexagons by a random part of its period; takes other Voronoi cells and triangles."},
        {.path = "replicas.rotation",
         .type = KeyType::number,
         .measure = Measure::angle,
         .range = {.least = 0.0, .most = 180.0},
         .fallback = "0",
         .doc = "Turns the net by at most this angle to either side."},
    };
}

std::vector<KeyRule> result_rules() {
    return {
        {.path = "quantities",
         .type = KeyType::texts,
         .fallback = "[peak_stress, peak_strain]",
         .least_items = 1,
         .doc = "Numbers of summary.json."},
        {.path = "curve",
         .type = KeyType::boolean,
         .fallback = "true",
         .doc = "Also the distance of the curves of differential stress over axial strain."},
        {.path = "reference",
         .type = KeyType::choice_or_mapping,
         .choices = {"finest", "none"},
         .fallback = "finest",
         .doc = "What cases are compared with: the last value of `along`, another case, closed forms or another run."},
        {.path = "reference.case",
         .type = KeyType::named,
         .doc = "The case with these settings that is alike in everything else."},
        {.path = "reference.case.*",
         .type = KeyType::value,
         .doc = "A value that varies in the study, or the name of a variant."},
        {.path = "reference.values",
         .type = KeyType::named,
         .least_items = 1,
         .doc = "Numbers for the quantities, in SI."},
        {.path = "reference.values.*", .type = KeyType::number, .doc = "Without a unit."},
        {.path = "reference.directory",
         .type = KeyType::text,
         .doc = "Results of another run, relative to the study file."},
        {.path = "along",
         .type = KeyType::text,
         .fallback_note = "the first such key that refines the solution, or else is a method or a number of the net; "
                          "no strength, stiffness or load",
         .doc = "The varied key, with numbers as values, that leads to the finest case."},
        {.path = "pictures",
         .type = KeyType::boolean,
         .fallback = "false",
         .doc = "Whether each case has its pictures."},
        {.path = "time_limit",
         .type = KeyType::number,
         .range = {.least = 0.0, .most = 1e9},
         .fallback = "0",
         .doc = "Seconds after which a case is stopped; 0: never."},
    };
}

} // namespace

const KeyTable& study_schema() {
    static const KeyTable keys([] {
        std::vector<KeyRule> rules;
        for (const auto& part : {general_rules(), variant_rules(), replica_rules(), result_rules()})
            rules.insert(rules.end(), part.begin(), part.end());
        return rules;
    }());
    return keys;
}

} // namespace kluft
