#!/usr/bin/env python3
"""Prints what happens at a competition: live_data.py ADDRESS, such as 192.168.1.10:8081. Needs only python3-tornado."""

import asyncio
import json
import sys

from tornado.websocket import websocket_connect


async def follow(address):
    """Print changes until the gateway ends, and report changes that were missed."""
    connection = await websocket_connect(f"ws://{address}/api/v1/events?documents=state,results")
    numbers = {}
    while True:
        text = await connection.read_message()
        if text is None:
            return
        message = json.loads(text)
        if not message["heard"]:
            print("The box is silent: this is its last known state", flush=True)
        for name, document in message.get("documents", {}).items():
            if document["number"] > numbers.get(name, document["number"]) + 1:
                print(f"Some changes of {name} were missed; this is the newest state", flush=True)
            numbers[name] = document["number"]
            for run in (document["data"] or {}).get("runs", []):
                print(f"{run['zone']}: {run['team']}, {run['benchmark']}: {run['phase']}", flush=True)
            for result in (document["data"] or {}).get("results", []):
                print(f"Result of {result['team']} in {result['benchmark']}: {result['end_reason']}", flush=True)


asyncio.run(follow(sys.argv[1]))
