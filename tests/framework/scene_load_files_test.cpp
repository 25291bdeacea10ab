// Models: OBJ, MTL and images, good and bad files.
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <limits>

#include "framework/one_mesh.h"
#include "lumivox/base/error.h"
#include "lumivox/base/image.h"
#include "lumivox/base/log.h"
#include "lumivox/scene/scene.h"
#include "support/facts.h"
#include "support/gzip.h"
#include "support/support.h"

using namespace lumivox;
using Catch::Matchers::Contains;
using lumivox::test::Tells;
using test::kCube, test::kTriangle, test::loadLogged, test::OneMesh, test::tga;

namespace {

/// A triangle of material `a`, whose file `m.mtl` says `mtl`, beside the image `p.tga` or `p.png`.
OneMesh withMaterial(const std::string& mtl, const std::string& name = "", const std::string& image = "") {
  OneMesh mesh(std::string("mtllib m.mtl\nusemtl a\n") + kTriangle);
  mesh.directory.write("m.mtl", mtl);
  if (!name.empty()) mesh.directory.write(name, image);
  return mesh;
}

std::string repeated(const std::string& part, int times) {
  std::string result;
  for (int i = 0; i < times; ++i) result += part;
  return result;
}

}  // namespace

TEST_CASE("a diffuse image is decoded from sRGB to linear values with row 0 on top") {
  const Scene scene = withMaterial("newmtl a\nmap_Kd images\\p.tga\n", "images/p.tga",
                                   tga(1, 2, 3, {255, 188, 0, 10, 20, 30}))
                          .load();
  REQUIRE(scene.textures.size() == 1);
  const SurfaceTexture& texture = scene.textures[0];
  CHECK((texture.width == 1 && texture.height == 2));
  REQUIRE(texture.values.size() == 6);
  CHECK(texture.values[0] == Approx(1.0f));
  // IEC 61966-2-1: ((188/255 + 0.055) / 1.055)^2.4 = 0.502886
  CHECK(texture.values[1] == Approx(0.502886f).epsilon(1e-5));
  CHECK(texture.values[2] == 0.0f);
  // An image without Kd is the albedo itself.
  CHECK(scene.materials[0].diffuse == glm::vec3(1.0f));
}

TEST_CASE("a mask is taken from alpha where there is one and from the first channel otherwise") {
  const auto [image, dissolve, expected] = GENERATE(table<std::string, const char*, std::vector<float>>({
      {tga(2, 1, 4, {1, 2, 3, 255, 200, 200, 200, 0}), "", {1.0f, 0.0f}},
      {tga(2, 1, 1, {51, 255}), "", {0.2f, 1.0f}},
      {tga(2, 1, 1, {255, 0}), "d 0.75\n", {0.75f, 0.0f}},
  }));
  const Scene scene =
      withMaterial(std::string("newmtl a\nKd 1 1 1\nmap_d p.tga\n") + dissolve, "p.tga", image).load();
  CHECK(SceneTraits::of(scene).masks);
  CHECK(scene.textures.at(0).values == expected);
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
  const std::string obj = std::string("mtllib none.mtl\nusemtl a\n") + kTriangle;
  const OneMesh mesh(obj);
  const auto [scene, log] = loadLogged(mesh);
  CHECK_THAT(log, Tells("none.mtl", "exist", "grey", 0.8));
  CHECK(log.find("warning") == log.rfind("warning"));  // one mistake, one message
  CHECK(scene.materials.at(0).diffuse == glm::vec3(0.8f));
  CHECK_THROWS_MATCHES(mesh.load(true), Error, Tells("none.mtl", "--strict"));
  CHECK(loadLogged(OneMesh(obj, "material red", "material red { diffuse 1 0 0 }")).second.empty());
}

TEST_CASE("names with blanks work for material files and materials") {
  OneMesh mesh("mtllib my materials.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl deep red\nf 1 2 3 # a comment\n");
  mesh.directory.write("my materials.mtl", "newmtl  deep red \nKd 0.5 0 0\n");
  const auto [scene, log] = loadLogged(mesh);
  CHECK(log.empty());
  CHECK(scene.materials.at(0).diffuse == glm::vec3(0.5f, 0, 0));
}

TEST_CASE("bad triangles are dropped, counted by kind with their first lines; strict refuses them") {
  const OneMesh mesh(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nv 2 0 0\nv 1e39 0 0\n"  // lines 1 to 6
      "f 1 2 3\nf 1 2 9\nf 0 1 2\nf 1 2 5\nf 1 2 2\nf 1 2 4\nf 3 2 6\n");
  const auto [scene, log] = loadLogged(mesh);
  CHECK(scene.triangleCount() == 1);
  CHECK_THAT(log, Tells("m.obj", 6, 7, 2, "index", "line 8", 2, "finite", 2, "line 4", 2, "area", "line 10"));
  for (const glm::vec3& position : scene.positions) CHECK(std::isfinite(position.x));
  CHECK_THROWS_MATCHES(mesh.load(true), Error, Tells(6, 7, "--strict"));
}

TEST_CASE("a vertex may be defined behind the face that uses it") {
  CHECK(OneMesh("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n").load().triangleCount() == 1);
}

TEST_CASE("normals and texture coordinates that are not finite are replaced and warned of") {
  const OneMesh mesh("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn nan 0 1\nvt inf 1\nf 1/1/1 2/1/1 3/1/1\n");
  const auto [scene, log] = loadLogged(mesh);
  CHECK_THAT(log, Tells("not finite"));
  for (const glm::vec3& normal : scene.normals) CHECK(glm::length(normal) == Approx(1.0f));
  for (const glm::vec2& texcoord : scene.texcoords) CHECK(std::isfinite(texcoord.x));
}

TEST_CASE("each way in which an OBJ file can be no OBJ file gives one error with its line") {
  const auto [obj, told] = GENERATE(table<std::string, Tells>({
      {"", Tells("m.obj", "no faces")},
      {"# nothing\nv 0 0 0\n", Tells("m.obj", "no faces")},
      {"v 0 0 0\nv 1 0\n", Tells("m.obj:2", "v", 2, "truncated")},
      {"v 0 0 0\nv 1 x 0\nf 1 1 1\n", Tells("m.obj:2", "x", "v", "number")},
      {"v 0 0 0\nf 1 2\n", Tells("m.obj:2", "face", 2)},
      {"v 0 0 0\nf 1" + repeated(" 1", 1999) + "\n", Tells("face", 2000, 1024)},
      {"v 0 0 0\nf 1 2 x\n", Tells("m.obj:2", "corner", "x")},
      {"v 0 0 0\nf 1/2/3/4 1 1\n", Tells("corner", "1/2/3/4")},
      {std::string("\x7F"
                   "ELF\0\0\1",
                   7),
       Tells("m.obj:1", "OBJ")},
      {"{\"asset\": 1}\n", Tells("m.obj:1", "OBJ")},
      {"v 0 0 0\nf 1 1 1\n", Tells("no triangle")},
  }));
  CAPTURE(obj.substr(0, 40));
  CHECK_THAT(OneMesh(obj).error(), told);
  for (const char* corner : {"1/", "1//", "1/1/", "/1", "//1", "1.5", "1/x"})
    CHECK_THAT(OneMesh(fmt::format("v 0 0 0\nvt 0 0\nvn 0 0 1\nf 1 {} 1\n", corner)).error(),
               Tells("corner", corner));
}

TEST_CASE("index numbers beyond every integer are broken indices, not crashes") {
  const auto [scene, log] = loadLogged(OneMesh(
      std::string(kTriangle) + "f 1 2 99999999999999999999999\nf -99999999999 1 2\nf 1 2 2147483647\n"));
  CHECK(scene.triangleCount() == 1);
  CHECK_THAT(log, Tells(3, "index", "line 5"));
}

TEST_CASE("statements that carry no triangles are named once") {
  const auto [scene, log] =
      loadLogged(OneMesh(std::string("p 1\nl 1 2\ncurv 0 1 1 2\nsurf x\n") + kTriangle));
  CHECK(scene.triangleCount() == 1);
  CHECK_THAT(log, Tells("without triangles", "curv", "surf"));
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
  const std::string packed = test::gzip(kCube);
  CHECK(load(packed).triangleCount() == 12);
  for (const std::string& broken : {packed.substr(0, packed.size() / 2), std::string(), std::string(kCube)})
    CHECK_THROWS_MATCHES(load(broken), Error, Tells("m.obj.gz", "gzip"));
}

TEST_CASE("each way in which an MTL file can be wrong gives one error with its line") {
  const auto [mtl, told] = GENERATE(table<std::string, Tells>({
      {"", Tells("m.mtl", "no material")},
      {"newmtl a\nKd 0.5 0.5\n", Tells("m.mtl:2", "Kd", "a", "three")},
      {"newmtl a\nKd 0.5 red 0\n", Tells("m.mtl:2", "Kd", "a", "red")},
      {"newmtl a\nKe nan 0 0\n", Tells("Ke", "a", "nan")},
      {"newmtl a\nKs 1 1 -1\n", Tells("Ks", "a", "negative")},
      {"newmtl a\nKe 0 1e30 0\n", Tells("Ke", "a", "1e30", "1e+15")},
      {"newmtl a\nNs 1e30\n", Tells("Ns", "a", "1e30", "1e+06")},
      {"newmtl a\nKd 1e30 0 0\n", Tells("Kd", "a", "1e30", 1000)},
      {"Kd 1 1 1\n", Tells("m.mtl:1", "Kd", "before", "newmtl")},
      {"newmtl\n", Tells("m.mtl:1", "newmtl", "name")},
      {std::string("newmtl a\n\0\0", 11), Tells("m.mtl", "zero byte")},
  }));
  CAPTURE(mtl);
  CHECK_THAT(withMaterial(mtl).error(), told);
}

TEST_CASE("maps that the house does not know are named, once for a model") {
  CHECK_THAT(loadLogged(withMaterial("newmtl a\nKd 1 1 1\nmap_Ks s.png\nmap_bump b.png\n")).second,
             Tells("m.obj", "not used", "map_Ks", "map_bump"));
}

TEST_CASE("missing, empty, truncated and malformed images are errors that name them") {
  const std::string png = encodePng(ImageBuffer(8, 8, 3, 0.5f)), mtl = "newmtl a\nmap_Kd p.png\n";
  CHECK_THAT(withMaterial(mtl).error(), Tells("p.png"));
  for (const std::string& image :
       {std::string(), std::string("this is no image"), png.substr(0, png.size() / 2)})
    CHECK_THAT(withMaterial(mtl, "p.png", image).error(), Tells("p.png"));
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
