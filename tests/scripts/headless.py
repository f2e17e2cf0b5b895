"""A browser without a screen for the tests of pages, and what was wrong on a page."""
import json
import shutil

CHROMIUM, DRIVER = shutil.which("chromium"), shutil.which("chromedriver")
# As root Chromium has no sandbox; without a graphics card it draws by SwiftShader. No host name leads anywhere.
FLAGS = ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--use-gl=angle", "--use-angle=swiftshader",
         "--enable-unsafe-swiftshader", "--window-size=960,640", "--force-device-scale-factor=1",
         "--host-resolver-rules=MAP * ~NOTFOUND", "--disable-background-networking", "--disable-component-update"]


def what_is_missing():
    """In words; None where tests can run."""
    try:
        import selenium  # noqa: F401
    except ImportError:
        return "python3-selenium is not installed; scripts/setup installs it"
    if not CHROMIUM or not DRIVER:
        return "chromium or chromium-driver is not installed; scripts/setup installs both"
    return None


def browser(*flags):
    from selenium import webdriver
    from selenium.webdriver.chrome.options import Options
    from selenium.webdriver.chrome.service import Service
    options = Options()
    options.binary_location = CHROMIUM
    for flag in (*FLAGS, *flags):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    return webdriver.Chrome(service=Service(DRIVER), options=options)


def complaints(driver):
    """Messages of the console."""
    return [entry["message"] for entry in driver.get_log("browser") if entry["level"] in ("WARNING", "SEVERE")]


def requests(driver):
    """Addresses that the page asked for, its own among them; those inside the page (data:, blob:) are none."""
    messages = [json.loads(entry["message"])["message"] for entry in driver.get_log("performance")]
    found = [m["params"]["request"]["url"] for m in messages if m["method"] == "Network.requestWillBeSent"]
    return [address for address in found if not address.startswith(("data:", "blob:"))]
