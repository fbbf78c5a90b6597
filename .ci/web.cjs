// usage: node .ci/web.cjs FOLDER NATIVE PICTURES [PART OF A TEST'S NAME]: plays the game in FOLDER in headless Chromium,
// compares the CSVs of its headless comparison with those of the native program, NATIVE/SCENE.csv, and leaves pictures.
const { createHash } = require("node:crypto");
const { createServer } = require("node:http");
const { readFileSync, readdirSync, existsSync, mkdirSync } = require("node:fs");
const { join, extname } = require("node:path");
const assert = require("node:assert");
const { chromium } = require("playwright-core");

const [folder, native, pictures, only] = process.argv.slice(2);
mkdirSync(pictures, { recursive: true });
// A software renderer on a busy machine draws a frame a second. Nothing below waits for a time, only for conditions.
const PATIENCE = 180_000;
/** The longest test [ms]: a page that hangs fails one test, and not the run. */
const LONGEST = 10 * PATIENCE;
/** The folder of the program in the page's folder. */
const program = readdirSync(folder).find((name) => name.startsWith("program-"));

const TYPES = { ".html": "text/html", ".js": "text/javascript", ".wasm": "application/wasm", ".png": "image/png" };
const SCENE = '(id: "dropped", title: "A dropped scene", duration: 5, body: (half_extents: (1, 0.5, 0.25), mass: 2))';
const SCRIPTS = {
  "/change.ron": `[(at: 0.0, actions: [SelectScene("throw"), SetIntegrator("rk4"), Set(Gravity, 1.62), SetSpeed(0.5)]),
    (at: 0.1, actions: [CopyCommandLine])]`,
  "/copy.ron": "[(at: 0.1, actions: [CopyCommandLine])]",
};
const server = createServer((request, answer) => {
  const path = new URL(request.url, "http://localhost").pathname;
  if (path === "/far/away.ron") return answer.end(SCENE.replace("A dropped scene", "A scene from afar"));
  if (SCRIPTS[path]) return answer.end(SCRIPTS[path]);
  const file = join(folder, path === "/" ? "index.html" : path);
  if (path.endsWith("/box_game.brotli") && request.headers.referer?.includes("breaks-off")) {
    const whole = readFileSync(file);
    answer.writeHead(200, { "content-length": whole.length });
    return answer.write(whole.subarray(0, 1e6), () => request.socket.destroy());
  }
  if (!existsSync(file)) return answer.writeHead(404).end();
  answer.writeHead(200, { "content-type": TYPES[extname(file)] ?? "application/octet-stream" });
  answer.end(readFileSync(file));
});

/** The columns of a CSV that are the same on every machine, all but the times: the digest of each. */
function bits(text) {
  const [head, ...rows] = text.split("\n").filter((line) => line && !line.startsWith("#")).map((line) => line.split(","));
  const digest = (k) => createHash("sha256").update(rows.map((row) => row[k]).join("\n")).digest("hex").slice(0, 16);
  const columns = head.map((name, k) => [name, digest(k)]).filter(([name]) => !name.startsWith("step_ns_"));
  return { rows: rows.length, ...Object.fromEntries(columns) };
}

/** The objects of a CSV. No cell of ours has a comma but those of `event`, the last. */
function table(text) {
  const [head, ...rows] = text.split("\n").filter((line) => line && !line.startsWith("#")).map((line) => line.split(","));
  return rows.map((row) => Object.fromEntries(head.map((name, k) => [name, k + 1 < head.length ? row[k] : row.slice(k).join(",")])));
}

async function main() {
  await new Promise((done) => server.listen(0, "127.0.0.1", done));
  const address = `http://127.0.0.1:${server.address().port}/`;
  const launch = (...more) => chromium.launch({
    executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
    args: [...more, "--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
      "--ignore-gpu-blocklist", "--disable-quic", "--no-first-run", "--disable-background-networking",
      "--disable-component-update", "--disable-sync"],
  });
  const browser = await launch();

  /** Opens the page; its errors fail the test that has it open. */
  async function open(query, options = {}, prepare, inside = browser) {
    const context = await inside.newContext({ viewport: { width: 1280, height: 720 }, acceptDownloads: true, ...options });
    context.setDefaultTimeout(PATIENCE);
    const page = await context.newPage();
    const errors = [];
    page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
    page.on("pageerror", (error) => errors.push(String(error)));
    page.on("crash", () => errors.push("the page has crashed"));
    await prepare?.(page);
    await page.goto(address + query);
    return {
      page,
      errors,
      running: () => page.locator("#cover").waitFor({ state: "hidden" }),
      /** The window's title, which names scene and integrator. */
      titled: (...words) => page.waitForFunction(
        (words) => words.every((word) => document.getElementById("game").getAttribute("alt")?.includes(word)), words),
      /** Waits until this many more frames are drawn. */
      frames: (n) => page.evaluate((n) => new Promise((done) => {
        const next = () => (n-- > 0 ? requestAnimationFrame(next) : done());
        next();
      }), n),
      press: (key) => page.keyboard.press(key, { delay: 50 }),
      download: async (start) => {
        const [file] = await Promise.all([page.waitForEvent("download"), start()]);
        return { name: file.suggestedFilename(), text: readFileSync(await file.path(), "utf8") };
      },
      picture: (name) => page.screenshot(name ? { path: join(pictures, name) } : {}),
      close: async () => {
        await context.close();
        assert.deepEqual(errors, [], "errors in the console");
      },
    };
  }

  /** Number of colors in a picture, and of points at which another differs. */
  async function compare(page, one, other) {
    return page.evaluate(async (pictures) => {
      const points = [];
      for (const picture of pictures) {
        const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${picture}`)).blob());
        const canvas = new OffscreenCanvas(image.width, image.height).getContext("2d");
        canvas.drawImage(image, 0, 0);
        points.push(new Uint32Array(canvas.getImageData(0, 0, image.width, image.height).data.buffer));
      }
      const [a, b] = points;
      return { colors: new Set(a).size, different: a.reduce((n, color, k) => n + (color !== b[k]), 0) };
    }, [one.toString("base64"), other.toString("base64")]);
  }

  /** Notes the parts of the download, and when the first picture is shown. */
  const watchStart = (page) => page.addInitScript(() => addEventListener("DOMContentLoaded", () => {
    const [cover, bar] = ["cover", "bar"].map((id) => document.getElementById(id));
    const watch = (element, attribute, seen) => new MutationObserver(seen).observe(element, { attributeFilter: [attribute] });
    watch(cover, "hidden", () => { globalThis.shown ??= performance.now(); });
    globalThis.progress = [];
    watch(bar, "value", () => globalThis.progress.push(bar.value));
  }));

  /** The parts of the download, and the times [s] of its last byte and of the first picture. */
  async function started(game) {
    await game.running();
    const [progress, ...times] = await game.page.evaluate(() => [
      globalThis.progress,
      performance.getEntriesByType("resource").find((entry) => entry.name.endsWith(".brotli")).responseEnd,
      globalThis.shown,
    ]);
    const [loaded, shown] = times.map((time) => time / 1000);
    console.log(`   last byte after ${loaded.toFixed(1)} s, first picture after ${shown.toFixed(1)} s`);
    return { progress, loaded, shown };
  }

  const tests = {
    "it loads, obeys its query, and a box tumbles": async () => {
      const game = await open("?scene=dzhanibekov&integrator=split,rk4&plot=error&no-settings&utm_source=test", {}, watchStart);
      const { progress, shown } = await started(game);
      assert(progress.length > 2 && progress.at(-1) === 1, `${progress}`);
      assert(progress.every((part, k) => k === 0 || part >= progress[k - 1]), `${progress}`);
      assert(shown < 10, "ten seconds on software rendering");
      await game.titled("Dzhanibekov", "– split –");
      const first = await game.picture();
      const end = Date.now() + PATIENCE;
      let seen;
      do {
        assert(Date.now() < end, "the box stands still");
        seen = await compare(game.page, first, await game.picture("web.png"));
      } while (seen.different < 2000);
      assert(seen.colors > 100, `${seen.colors} colors`);
      const began = Date.now();
      await game.frames(20);
      console.log(`   a frame in ${((Date.now() - began) / 20).toFixed(0)} ms`);
      await game.close();
    },

    "it loads over a line of 20 Mbit/s": async () => {
      const game = await open("?scene=dzhanibekov&no-settings", {}, async (page) => {
        const session = await page.context().newCDPSession(page);
        await session.send("Network.emulateNetworkConditions",
          { offline: false, latency: 20, downloadThroughput: 2.5e6, uploadThroughput: 1e6 });
        await watchStart(page);
      });
      const { loaded } = await started(game);
      const least = readFileSync(join(folder, program, "box_game.brotli")).length / 2.5e6;
      assert(loaded > 0.8 * least, `${loaded} s: the emulated line had no effect`);
      await game.close();
    },

    "a key pushes it, another switches the integrator, and the log of that is a download": async () => {
      const game = await open("?scene=dzhanibekov&integrator=split&no-settings");
      await game.running();
      await game.titled("– split –");
      for (const key of ["l", "d", "2"]) {
        await game.press(key);
        // Several keys in one slow frame would be a chord.
        await game.frames(2);
      }
      await game.page.waitForFunction(() => !document.getElementById("game").getAttribute("alt").includes("– split –"));
      await game.frames(5);
      const file = await game.download(() => game.press("l"));
      assert.match(file.name, /^run-\d+\.csv$/);
      const rows = table(file.text).filter((row) => row.trajectory === "0");
      const times = rows.map((row) => Number(row.sim_t_s));
      assert(times.every((t, k) => k === 0 || t > times[k - 1]), "time goes on");
      const events = rows.map((row) => row.event).join(";");
      assert.match(events, /push/i, events);
      const energies = new Set(rows.map((row) => Number(row.energy_j).toFixed(3)));
      assert(energies.size > 1, "the push changes the energy");
      await game.close();
    },

    "the headless comparison finds the bits of the native program": async () => {
      const scenes = readdirSync(native).map((name) => name.replace(/\.csv$/, ""));
      assert(scenes.length > 1);
      for (const scene of scenes) {
        const game = await open(`?scene=${scene}&headless&duration=2`);
        const path = await new Promise((done, failed) => {
          game.page.once("download", async (file) => done(await file.path()));
          setTimeout(() => failed(new Error("no download")), PATIENCE).unref();
        });
        const texts = [path, join(native, `${scene}.csv`)].map((path) => readFileSync(path, "utf8"));
        const [here, there] = texts.map(bits);
        console.log(`   ${scene}: ${here.rows} rows of ${Object.keys(here).length - 1} columns`);
        const costs = texts.map((text) => new Map(table(text).map((row) => [row.integrator, Number(row.step_ns_min)])));
        console.log("   | integrator | browser [ns] | native [ns] | ratio |\n   |---|---|---|---|");
        for (const [id, ns] of costs[0]) {
          const beside = costs[1].get(id);
          console.log(`   | \`${id}\` | ${ns.toPrecision(3)} | ${beside.toPrecision(3)} | ${(ns / beside).toFixed(1)} |`);
        }
        assert(there.rows > 100);
        assert.deepEqual(here, there);
        await game.page.locator("dialog pre", { hasText: "semi-implicit-euler" }).waitFor();
        await game.close();
      }
    },

    "a wrong argument is named, with what is allowed, and the game starts without it": async () => {
      const game = await open("?integrator=leapfrog");
      const text = await game.page.locator("dialog.failed pre").textContent();
      assert(text.includes("leapfrog") && text.includes("rk4"), text);
      await game.page.locator("dialog button").click();
      await game.page.waitForURL(address);
      await game.running();
      await game.titled("Dzhanibekov");
      await game.close();
    },

    "a scene that cannot be fetched is named, with the reason": async () => {
      const game = await open("?scene=far/nowhere.ron");
      await game.page.locator("#reload").waitFor();
      const text = await game.page.locator("#text").textContent();
      assert(text.includes("far/nowhere.ron") && text.includes("404"), text);
      game.errors.length = 0;
      await game.close();
    },

    "a crash at the start is reported": async () => {
      const game = await open("?no-settings", {}, (page) => page.addInitScript(() => {
        const { getContext } = HTMLCanvasElement.prototype;
        // The page looks for WebGL 2 on a canvas of its own; the game finds none.
        HTMLCanvasElement.prototype.getContext = function (...of) { return this.id === "game" ? null : getContext.apply(this, of); };
      }));
      await game.page.locator("#reload").waitFor();
      assert.match(await game.page.locator("#text").textContent(), /has crashed/);
      game.errors.length = 0;
      await game.close();
    },

    "a scene is opened by its address, and by dropping its file": async () => {
      const game = await open("?scene=far/away.ron&no-settings");
      await game.running();
      await game.titled("A scene from afar");
      await game.page.evaluate((text) => {
        const transfer = new DataTransfer();
        transfer.items.add(new File([text], "dropped.ron"));
        document.body.dispatchEvent(new DragEvent("drop", { dataTransfer: transfer, bubbles: true, cancelable: true }));
      }, SCENE.replaceAll("dropped", "dropped2").replace("A dropped2", "A dropped"));
      await game.titled("A dropped scene");
      await game.close();
    },

    "a tablet's screen is sharp": async () => {
      // The emulated ratio of a page does not reach its observers of sizes: a browser of its own.
      const tablet = await launch("--force-device-scale-factor=2", "--window-size=1024,768");
      try {
        const game = await open("?scene=dzhanibekov&no-settings", { viewport: null, hasTouch: true }, undefined, tablet);
        await game.running();
        await game.titled("Dzhanibekov");
        await game.page.waitForFunction(() =>
          devicePixelRatio === 2 && document.getElementById("game").width === 2 * innerWidth);
        await game.picture("tablet.png");
        await game.close();
      } finally {
        await tablet.close();
      }
    },

    "the picture follows the size of the page": async () => {
      const game = await open("?no-settings");
      await game.running();
      for (const [width, height] of [[900, 600], [1100, 700]]) {
        await game.page.setViewportSize({ width, height });
        await game.page.waitForFunction(([width, height]) => {
          const canvas = document.getElementById("game");
          return canvas.width === width && canvas.height === height;
        }, [width, height]);
      }
      await game.close();
    },

    "fingers turn the view and bring it nearer": async () => {
      const game = await open("?scene=dzhanibekov&no-settings", { hasTouch: true });
      await game.running();
      await game.titled("Dzhanibekov");
      for (const key of ["Space", "Backquote"]) {
        await game.press(key);
        await game.frames(3);
      }
      const session = await game.page.context().newCDPSession(game.page);
      const touch = async (type, ...places) => {
        await session.send("Input.dispatchTouchEvent", { type, touchPoints: places.map(([x, y], id) => ({ x, y, id })) });
        await game.frames(2);
      };
      const changed = async (gesture) => {
        const before = await game.picture();
        await gesture();
        await game.frames(3);
        return (await compare(game.page, before, await game.picture())).different;
      };
      const still = await changed(async () => {});
      const turned = await changed(async () => {
        for (const k of [0, 1, 2, 3]) await touch(k ? "touchMove" : "touchStart", [150 + 60 * k, 400]);
        await touch("touchEnd");
      });
      const nearer = await changed(async () => {
        for (const k of [0, 1, 2, 3]) await touch(k ? "touchMove" : "touchStart", [300 - 40 * k, 400], [500 + 40 * k, 400]);
        await touch("touchEnd");
      });
      for (const points of [turned, nearer]) assert(points > still + 5000, `${points} points, ${still} at rest`);
      await game.close();
    },

    "the keys of the game are kept from the browser, and no others": async () => {
      const game = await open("?no-settings");
      await game.running();
      const kept = await game.page.evaluate(() => {
        const press = (code, modifiers) => !document.getElementById("game").dispatchEvent(
          new KeyboardEvent("keydown", { code, ...modifiers, bubbles: true, cancelable: true }));
        const [ctrlKey, metaKey, altKey] = [true, true, true];
        return [["Space"], ["Backspace"], ["KeyO", { ctrlKey }], ["KeyZ", { metaKey }], ["KeyD", { altKey }],
          ["BracketRight", { ctrlKey, key: "+" }], ["F12"], ["F5"], ["KeyW", { ctrlKey }], ["KeyR", { ctrlKey }],
          ["KeyC", { metaKey }], ["KeyF", { altKey }], ["KeyQ", { ctrlKey, altKey }]]
          .filter((key) => press(...key)).map(([code]) => code);
      });
      assert.deepEqual(kept, ["Space", "Backspace", "KeyO", "KeyZ", "KeyD", "BracketRight"]);
      await game.close();
    },

    "preferences outlive the page": async () => {
      const game = await open("");
      const stored = (word) => game.page.waitForFunction((word) => JSON.stringify(localStorage).includes(word), word);
      for (const shown of [true, false]) {
        // The second time the key switches off what was kept.
        await game.running();
        await game.press("b");
        await stored(`show_aabb = ${shown}`);
        if (shown) await game.page.reload();
      }
      await game.close();
    },

    "the copied address restores the session": async () => {
      const copied = async (query) => {
        const game = await open(query, {}, (page) => page.addInitScript(() => {
          navigator.clipboard.writeText = async (text) => { globalThis.copied = text; };
        }));
        await game.running();
        const text = await (await game.page.waitForFunction(() => globalThis.copied)).jsonValue();
        await game.titled("Tumbling throw", "– rk4 –");
        await game.close();
        return text;
      };
      const first = await copied("?script=change.ron&no-settings");
      assert(first.startsWith(address) && first.includes("1.62"), first);
      assert.equal(await copied(`${first.slice(address.length)}&script=copy.ron&no-settings`), first);
    },

    "where the browser refuses to copy, the page shows the text": async () => {
      for (const refuses of [false, true]) {
        const game = await open("?script=copy.ron&no-settings", {}, (page) => page.addInitScript((refuses) => {
          const writeText = async () => { throw new Error("refused"); };
          Object.defineProperty(navigator, "clipboard", { value: refuses ? { writeText } : undefined });
        }, refuses));
        await game.page.locator("dialog pre", { hasText: `${address}?scene=` }).waitFor();
        await game.page.locator("dialog button").click();
        await game.frames(3);
        await game.close();
      }
    },

    "a download that breaks off is reported, with a button to reload": async () => {
      const game = await open("?breaks-off");
      await game.page.locator("#reload").waitFor();
      assert.match(await game.page.locator("#text").textContent(), /could not be loaded/);
      game.errors.length = 0;
      await game.page.context().close();
    },

    "a lost context is said, with a way back": async () => {
      const game = await open("?no-settings");
      await game.running();
      await game.page.evaluate(() => document.getElementById("game").getContext("webgl2").getExtension("WEBGL_lose_context").loseContext());
      await game.page.locator("#reload").waitFor();
      assert.match(await game.page.locator("#text").textContent(), /graphics context/);
      game.errors.length = 0;
      await game.page.context().close();
    },

    "a browser without WebGL 2 shows the film, and does not load the game": async () => {
      const loaded = [];
      const game = await open("", {}, (page) => {
        page.on("request", (request) => loaded.push(request.url()));
        return page.addInitScript(() => {
          HTMLCanvasElement.prototype.getContext = () => null;
        });
      });
      await game.page.locator("#film").waitFor();
      assert(!loaded.some((url) => url.endsWith(".brotli")), `${loaded}`);
      assert.match(await game.page.locator("#text").textContent(), /WebGL 2/);
      await game.close();
    },
  };

  let failed = 0;
  const chosen = Object.entries(tests).filter(([name]) => name.includes(only ?? ""));
  for (const [name, test] of chosen) {
    const began = Date.now();
    const late = new Promise((_, failed) => setTimeout(() => failed(new Error("it hangs")), LONGEST).unref());
    try {
      await Promise.race([test(), late]);
      console.log(`ok   ${name} (${((Date.now() - began) / 1000).toFixed(1)} s)`);
    } catch (error) {
      failed += 1;
      console.log(`FAIL ${name}\n${error.stack ?? error}`);
    }
  }
  console.log(`${chosen.length - failed} passed, ${failed} failed`);
  // A browser that hangs would not close.
  process.exit(failed || !chosen.length ? 1 : 0);
}

main();
