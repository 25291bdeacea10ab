// Models: OBJ, MTL and images, good and bad files.
#include <fmt/format.h>
#include <zlib.h>

#include <chrono>
#include <cmath>
#include <limits>

#include "framework/one_mesh.h"
#include "lumivox/base/error.h"
#include "lumivox/base/image.h"
#include "lumivox/base/log.h"
#include "lumivox/scene/scene.h"
#include "support/support.h"

using namespace lumivox;
using Catch::Matchers::Contains;
using test::kCube, test::kTriangle, test::loadLogged, test::OneMesh, test::tga;

namespace {

std::string gzip(const std::string& text) {
  z_stream stream{};
  REQUIRE(deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) == Z_OK);
  std::string packed(text.size() + 1000, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  REQUIRE(deflate(&stream, Z_FINISH) == Z_STREAM_END);
  packed.resize(packed.size() - stream.avail_out);
  deflateEnd(&stream);
  return packed;
}

}  // namespace

TEST_CASE("a diffuse image is decoded from sRGB to linear values with row 0 on top") {
  OneMesh mesh("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
  mesh.directory.write("m.mtl", "newmtl a\nmap_Kd images\\p.tga\n");
  mesh.directory.write("images/p.tga", tga(1, 2, 3, {255, 188, 0, 10, 20, 30}));
  const Scene scene = mesh.load();
  REQUIRE(scene.textures.size() == 1);
  const SurfaceTexture& texture = scene.textures[0];
  CHECK(texture.width == 1);
  CHECK(texture.height == 2);
  REQUIRE(texture.values.size() == 6);
  CHECK(texture.values[0] == Approx(1.0f));
  // IEC 61966-2-1: ((188/255 + 0.055) / 1.055)^2.4 = 0.502886
  CHECK(texture.values[1] == Approx(0.502886f).epsilon(1e-5));
  CHECK(texture.values[2] == 0.0f);
  // An image without Kd is the albedo itself.
  CHECK(scene.materials[0].diffuse == glm::vec3(1.0f));
}

TEST_CASE("a mask is taken from alpha where there is one and from the first channel otherwise") {
  const auto maskOf = [](const std::string& image, const std::string& dissolve) {
    OneMesh mesh("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
    mesh.directory.write("m.mtl", "newmtl a\nKd 1 1 1\nmap_d p.tga\n" + dissolve);
    mesh.directory.write("p.tga", image);
    const Scene scene = mesh.load();
    CHECK(SceneTraits::of(scene).masks);
    return scene.textures.at(0).values;
  };
  CHECK(maskOf(tga(2, 1, 4, {1, 2, 3, 255, 200, 200, 200, 0}), "") == std::vector<float>{1.0f, 0.0f});
  CHECK(maskOf(tga(2, 1, 1, {51, 255}), "") == std::vector<float>{0.2f, 1.0f});
  CHECK(maskOf(tga(2, 1, 1, {255, 0}), "d 0.75\n") == std::vector<float>{0.75f, 0.0f});
}

TEST_CASE("an image that several materials use is read once, and unused ones are not read at all") {
  OneMesh mesh("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 3 2 1\n");
  mesh.directory.write("m.mtl",
                       "newmtl a\nmap_Kd p.tga\nnewmtl b\nmap_Kd ./p.tga\nnewmtl c\nmap_Kd none.png\n");
  mesh.directory.write("p.tga", tga(1, 1, 3, {1, 2, 3}));
  const Scene scene = mesh.load();
  CHECK(scene.textures.size() == 1);
  CHECK(scene.materials.size() == 2);
}

TEST_CASE("materials of the text may have images") {
  OneMesh mesh(kTriangle, "material cloth",
               "material cloth { diffuse 0.5  texture \"p.tga\"  mask \"p.tga\" }");
  mesh.directory.write("p.tga", tga(1, 1, 4, {255, 255, 255, 128}));
  const Scene scene = mesh.load();
  CHECK(scene.textures.size() == 2);
  CHECK(scene.materials.at(0).diffuseTexture >= 0);
  CHECK(scene.textures.at(static_cast<std::size_t>(scene.materials.at(0).maskTexture)).mask);
}

TEST_CASE("a surface with a coverage d below a half is left out") {
  OneMesh mesh("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl glass\nf 1 2 3\nusemtl wall\nf 3 2 1\n");
  mesh.directory.write("m.mtl", "newmtl glass\nKd 1 1 1\nd 0.1\nnewmtl wall\nKd 1 1 1\nd 0.9\n");
  const Scene scene = mesh.load();
  CHECK(scene.triangleCount() == 1);
  CHECK(scene.materials.at(0).name == "m/wall");
}

TEST_CASE("a missing material file is warned of and grey stands in; strict refuses it") {
  const OneMesh mesh("mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
  const auto [scene, log] = loadLogged(mesh);
  CHECK_THAT(log, Contains("none.mtl' does not exist"));
  CHECK_THAT(log, Contains("grey 0.8 is used instead of its materials"));
  CHECK_THAT(log, !Contains("is in none of its material files"));  // one mistake, one message
  CHECK(scene.materials.at(0).diffuse == glm::vec3(0.8f));
  CHECK_THAT(test::messageOf<Error>([&] { mesh.load(true); }), Contains("none.mtl") && Contains("--strict"));
  const OneMesh replaced("mtllib none.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n", "material red",
                         "material red { diffuse 1 0 0 }");
  CHECK(loadLogged(replaced).second.empty());
}

TEST_CASE("names with blanks work for material files and materials") {
  OneMesh mesh("mtllib my materials.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl deep red\nf 1 2 3 # a comment\n");
  mesh.directory.write("my materials.mtl", "newmtl  deep red \nKd 0.5 0 0\n");
  const auto [scene, log] = loadLogged(mesh);
  CHECK(log.empty());
  CHECK(scene.materials.at(0).diffuse == glm::vec3(0.5f, 0, 0));
}

TEST_CASE(
    "triangles with broken indices, without area or with coordinates that are not finite are dropped, "
    "counted and named") {
  const OneMesh mesh(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nv 2 0 0\nv 1e39 0 0\n"  // lines 1 to 6
      "f 1 2 3\nf 1 2 9\nf 0 1 2\nf 1 2 5\nf 1 2 2\nf 1 2 4\nf 3 2 6\n");
  const auto [scene, log] = loadLogged(mesh);
  CHECK(scene.triangleCount() == 1);
  CHECK_THAT(log, Contains("m.obj: 6 of 7 triangles are bad"));
  CHECK_THAT(log, Contains("2 with an index that no vertex has (first in line 8)"));
  CHECK_THAT(log, Contains("2 with coordinates that are not finite (2 such statements, first in line 4)"));
  CHECK_THAT(log, Contains("2 of zero area (first in line 10, object '')"));
  for (const glm::vec3& position : scene.positions) CHECK(std::isfinite(position.x));
  CHECK_THAT(test::messageOf<Error>([&] { mesh.load(true); }),
             Contains("6 of 7 triangles are bad") && Contains("refused under --strict"));
}

TEST_CASE("a vertex may be defined behind the face that uses it") {
  CHECK(OneMesh("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").load().triangleCount() == 1);
}

TEST_CASE("normals and texture coordinates that are not finite are replaced and warned of") {
  const OneMesh mesh("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn nan 0 1\nvt inf 1\nf 1/1/1 2/1/1 3/1/1\n");
  const auto [scene, log] = loadLogged(mesh);
  CHECK_THAT(log, Contains("not finite"));
  for (const glm::vec3& normal : scene.normals) CHECK(glm::length(normal) == Approx(1.0f));
  for (const glm::vec2& texcoord : scene.texcoords) CHECK(std::isfinite(texcoord.x));
}

TEST_CASE("each way in which an OBJ file can be no OBJ file gives one error with its line") {
  CHECK_THAT(OneMesh("").error(), Contains("m.obj: contains no faces"));
  CHECK_THAT(OneMesh("# nothing\nv 0 0 0\n").error(), Contains("m.obj: contains no faces"));
  CHECK_THAT(OneMesh("v 0 0 0\nv 1 0\n").error(),
             Contains("m.obj:2: statement 'v' has 2 numbers") && Contains("truncated"));
  CHECK_THAT(OneMesh("v 0 0 0\nv 1 x 0\nf 1 1 1\n").error(),
             Contains("m.obj:2: 'x' in statement 'v' is not a number"));
  CHECK_THAT(OneMesh("v 0 0 0\nf 1 2\n").error(), Contains("m.obj:2: a face with 2 corners"));
  CHECK_THAT(OneMesh("v 0 0 0\nf 1 2 x\n").error(), Contains("m.obj:2: malformed corner 'x'"));
  CHECK_THAT(OneMesh("v 0 0 0\nf 1/2/3/4 1 1\n").error(), Contains("malformed corner '1/2/3/4'"));
  for (const char* corner : {"1/", "1//", "1/1/", "/1", "//1", "1.5", "1/x"}) {
    CHECK_THAT(OneMesh(fmt::format("v 0 0 0\nvt 0 0\nvn 0 0 1\nf 1 {} 1\n", corner)).error(),
               Contains(fmt::format("malformed corner '{}'", corner)));
  }
  CHECK_THAT(OneMesh(std::string("\x7F"
                                 "ELF\0\0\1",
                                 7))
                 .error(),
             Contains("m.obj:1:") && Contains("is not a statement of an OBJ file"));
  CHECK_THAT(OneMesh("{\"asset\": 1}\n").error(), Contains("is not a statement of an OBJ file"));
  CHECK_THAT(OneMesh("v 0 0 0\nf 1 1 1\n").error(), Contains("no triangle is left"));
  std::string huge = "v 0 0 0\nf";
  for (int i = 0; i < 2000; ++i) huge += " 1";
  CHECK_THAT(OneMesh(huge + "\n").error(), Contains("a face with 2000 corners; expected at most 1024"));
}

TEST_CASE("index numbers beyond every integer are broken indices, not crashes") {
  const auto [scene, log] = loadLogged(OneMesh(
      std::string(kTriangle) + "f 1 2 99999999999999999999999\nf -99999999999 1 2\nf 1 2 2147483647\n"));
  CHECK(scene.triangleCount() == 1);
  CHECK_THAT(log, Contains("3 with an index that no vertex has (first in line 5)"));
}

TEST_CASE("statements that carry no triangles are named once") {
  const auto [scene, log] =
      loadLogged(OneMesh(std::string("p 1\nl 1 2\ncurv 0 1 1 2\nsurf x\n") + kTriangle));
  CHECK(scene.triangleCount() == 1);
  CHECK_THAT(log, Contains("statements without triangles are not used: curv, surf"));
}

TEST_CASE("line ends of all systems and continued lines are read") {
  CHECK(OneMesh("v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nf 1 2 3\r\n").load().triangleCount() == 1);
  CHECK(OneMesh("v 0 0 0\rv 1 0 0\rv 0 1 0\rf 1 2 3\r").load().triangleCount() == 1);
  CHECK(OneMesh("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 \\\n3").load().triangleCount() == 1);
}

TEST_CASE("a gzip-compressed model is the model, and a broken one is an error that names it") {
  const auto load = [](const std::string& packed) {
    const test::TemporaryDirectory directory;
    directory.write("m.obj.gz", packed);
    return loadScene(directory.write(
        "a.scene", "scene \"x\" { camera c { eye 0 0 1  target 0 0 0 }\nmesh m { file \"m.obj.gz\" }\n}"));
  };
  const std::string packed = gzip(kCube);
  CHECK(load(packed).triangleCount() == 12);
  CHECK_THAT(test::messageOf<Error>([&] { load(packed.substr(0, packed.size() / 2)); }),
             Contains("m.obj.gz: is not a whole gzip file"));
  CHECK_THAT(test::messageOf<Error>([&] { load(""); }), Contains("m.obj.gz: is not a whole gzip file"));
  CHECK_THAT(test::messageOf<Error>([&] { load(kCube); }), Contains("m.obj.gz: is not a whole gzip file"));
}

TEST_CASE("each way in which an MTL file can be wrong gives one error with its line") {
  const auto errorOf = [](const std::string& mtl) {
    OneMesh mesh("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
    mesh.directory.write("m.mtl", mtl);
    return mesh.error();
  };
  CHECK_THAT(errorOf(""), Contains("m.mtl: contains no material"));
  CHECK_THAT(errorOf("newmtl a\nKd 0.5 0.5\n"),
             Contains("m.mtl:2: 'Kd' of material 'a' is ''; expected three numbers"));
  CHECK_THAT(errorOf("newmtl a\nKd 0.5 red 0\n"), Contains("m.mtl:2: 'Kd' of material 'a' is 'red'"));
  CHECK_THAT(errorOf("newmtl a\nKe nan 0 0\n"), Contains("'Ke' of material 'a' is 'nan'"));
  CHECK_THAT(errorOf("newmtl a\nKs 1 1 -1\n"), Contains("'Ks' of material 'a' is negative"));
  CHECK_THAT(errorOf("newmtl a\nKe 0 1e30 0\n"),
             Contains("'Ke' of material 'a' is 1e30") && Contains("at most 1e+15"));
  CHECK_THAT(errorOf("newmtl a\nNs 1e30\n"),
             Contains("'Ns' of material 'a' is 1e30") && Contains("at most 1e+06"));
  CHECK_THAT(errorOf("newmtl a\nKd 1e30 0 0\n"),
             Contains("'Kd' of material 'a' is 1e30") && Contains("at most 1000"));
  CHECK_THAT(errorOf("Kd 1 1 1\n"), Contains("m.mtl:1: 'Kd' before the first newmtl"));
  CHECK_THAT(errorOf("newmtl\n"), Contains("m.mtl:1: newmtl without a name"));
  CHECK_THAT(errorOf(std::string("newmtl a\n\0\0", 11)), Contains("m.mtl: contains a zero byte"));
}

TEST_CASE("maps that the house does not know are named, once for a model") {
  OneMesh mesh("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
  mesh.directory.write("m.mtl", "newmtl a\nKd 1 1 1\nmap_Ks s.png\nmap_bump b.png\n");
  CHECK_THAT(loadLogged(mesh).second, Contains("m.obj: not used: map_Ks, map_bump"));
}

TEST_CASE("missing, empty, truncated and malformed images are errors that name them") {
  const auto errorOf = [](const std::optional<std::string>& image) {
    OneMesh mesh("mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
    mesh.directory.write("m.mtl", "newmtl a\nmap_Kd p.png\n");
    if (image) mesh.directory.write("p.png", *image);
    return mesh.error();
  };
  CHECK_THAT(errorOf(std::nullopt), Contains("p.png"));
  CHECK_THAT(errorOf(""), Contains("p.png"));
  CHECK_THAT(errorOf("this is no image"), Contains("p.png"));
  const std::string png = encodePng(ImageBuffer(8, 8, 3, 0.5f));
  CHECK_THAT(errorOf(png.substr(0, png.size() / 2)), Contains("p.png"));
}

TEST_CASE("a model of many parts and materials takes time in proportion to them") {
  // Every part has its own material: with a search through all for each, eight times as many would take 64
  // times as long. Linear work with its logarithms stays well below half of that.
  const auto secondsFor = [](int count) {
    std::string obj = "mtllib m.mtl\n", mtl;
    for (int i = 0; i < count; ++i) {
      obj += fmt::format("v {0} 0 0\nv {0} 1 0\nv {0} 0 1\nusemtl m{0}\nf -3 -2 -1\n", i);
      mtl += fmt::format("newmtl m{0}\nKd 0.5 0.5 0.{0}\n", i);
    }
    OneMesh mesh(obj, "use { mtl m1  material red }", "material red { diffuse 0.5 0 0 }");
    mesh.directory.write("m.mtl", mtl);
    double best = std::numeric_limits<double>::max();
    for (int i = 0; i < 3; ++i) {
      const auto begin = std::chrono::steady_clock::now();
      const Scene scene = mesh.load();
      best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
      CHECK(scene.materials.size() == static_cast<std::size_t>(count));
    }
    return best;
  };
  const double few = secondsFor(3000), many = secondsFor(24000);
  INFO(few << " s and " << many << " s");
  CHECK(many < 28.0 * few);
}
