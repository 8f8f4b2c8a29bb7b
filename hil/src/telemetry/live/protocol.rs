//! The Foxglove WebSocket protocol, version 1, as far as a server needs it that only sends: `serverInfo`, `advertise`, messages and time
//! to the viewer, `subscribe` and `unsubscribe` from it. Other requests are for capabilities that the server does not state.

use serde::Deserialize;
use serde_json::json;

use super::super::topic::Topic;

/// Subprotocols by which a viewer may ask. The second is that of Foxglove's own library, with the same messages.
pub const SUBPROTOCOLS: [&str; 2] = ["foxglove.websocket.v1", "foxglove.sdk.v1"];

const MESSAGE_DATA: u8 = 1;
const TIME: u8 = 2;

/// The first message to a viewer. The server states the simulated time, so that a viewer does not take the time of day.
pub fn server_info(name: &str) -> String {
    json!({ "op": "serverInfo", "name": name, "capabilities": ["time"], "supportedEncodings": [], "metadata": {} })
        .to_string()
}

/// The topics that a viewer may subscribe to; their channels are numbered from 1.
pub fn advertise(topics: &[Topic]) -> String {
    let channels: Vec<_> = (1..)
        .zip(topics)
        .map(|(id, topic): (u32, _)| {
            json!({
                "id": id, "topic": topic.name, "encoding": "json",
                "schemaName": topic.schema, "schema": topic.json_schema(), "schemaEncoding": "jsonschema",
            })
        })
        .collect();
    json!({ "op": "advertise", "channels": channels }).to_string()
}

/// A message of a topic for a subscription.
pub fn message(subscription: u32, time_ns: u64, text: &[u8]) -> Vec<u8> {
    let head = [&[MESSAGE_DATA][..], &subscription.to_le_bytes(), &time_ns.to_le_bytes()];
    [&head.concat(), text].concat()
}

/// The simulated time.
pub fn time(time_ns: u64) -> Vec<u8> {
    [&[TIME][..], &time_ns.to_le_bytes()].concat()
}

/// A request of a viewer.
#[derive(Debug, Deserialize, PartialEq, Eq)]
#[serde(tag = "op", rename_all = "camelCase")]
pub enum Request {
    /// Messages of these channels are wanted.
    Subscribe {
        /// Numbers that the viewer chooses, each for a channel.
        subscriptions: Vec<Subscription>,
    },
    /// Messages of these subscriptions are no longer wanted.
    #[serde(rename_all = "camelCase")]
    Unsubscribe {
        /// Numbers of subscriptions.
        subscription_ids: Vec<u32>,
    },
}

/// A viewer's number for a channel.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "camelCase")]
pub struct Subscription {
    /// The viewer's number.
    pub id: u32,
    /// Number of the channel.
    pub channel_id: u32,
}

/// What a viewer asks for; `None` for what this server does not do.
pub fn request(text: &str) -> Option<Request> {
    serde_json::from_str(text).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Texts and bytes of the specification.
    #[test]
    fn requests_and_messages_are_as_specified() {
        let subscribe = r#"{"op":"subscribe","subscriptions":[{"id":7,"channelId":3}]}"#;
        let subscriptions = vec![Subscription { id: 7, channel_id: 3 }];
        assert_eq!(request(subscribe), Some(Request::Subscribe { subscriptions }));
        let unsubscribe = r#"{"op":"unsubscribe","subscriptionIds":[7]}"#;
        let subscription_ids = vec![7];
        assert_eq!(request(unsubscribe), Some(Request::Unsubscribe { subscription_ids }));
        for other in ["", "{", r#"{"op":"getParameters"}"#, r#"{"op":"subscribe"}"#] {
            assert_eq!(request(other), None, "{other}");
        }
        assert_eq!(
            message(7, 258, b"{}"),
            [1, 7, 0, 0, 0, 2, 1, 0, 0, 0, 0, 0, 0, b'{', b'}']
        );
        assert_eq!(time(258), [2, 2, 1, 0, 0, 0, 0, 0, 0]);
    }
}
