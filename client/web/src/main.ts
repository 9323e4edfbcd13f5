import { Connection } from "./net/connection.ts";
import { keepLink, takeLink, type Link } from "./net/link.ts";
import { Landing } from "./panels/landing.ts";
import { Room } from "./room.ts";

// The page: a session that the link or this tab names, else the landing.
const page = document.getElementById("page");
const link = takeLink(location, history, sessionStorage);
const socket = new URL("ws", location.href);
socket.protocol = location.protocol === "https:" ? "wss:" : "ws:";
socket.hash = "";
const connection = new Connection(socket.href, link.token);

function land(token: string): void {
  keepLink({ session: "", token }, sessionStorage);
  const landing = new Landing(connection, token, open, (changed) => keepLink({ session: "", token: changed }, sessionStorage));
  page?.replaceChildren(landing.element);
}

function open(to: Link): void {
  keepLink(to, sessionStorage);
  connection.useToken(to.token);
  const room = new Room(connection, to.session, () => {
    room.close();
    land(to.token);
  });
  page?.replaceChildren(room.element);
  Object.assign(window, { lpvRoom: room }); // for the console, and tests
}

if (link.session) open(link);
else land(link.token);
