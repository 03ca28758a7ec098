; Rovers sample soil and rock, take pictures and send everything to a lander in sight.
;@ skill navigate 0 navigate ?r ?to
;@ skill sample-soil 0 sample-soil ?r
;@ skill sample-rock 0 sample-rock ?r
;@ skill discard 0 discard ?r
;@ skill calibrate 0 calibrate ?r ?c
;@ skill take-image 0 take-image ?r ?c ?o ?m
;@ skill send-soil 0 send-soil ?r ?of
;@ skill send-rock 0 send-rock ?r ?of
;@ skill send-image 0 send-image ?r ?o ?m
(define (domain rovers)
 (:requirements :strips :typing)
 (:types rover lander store camera mode waypoint objective)
 (:predicates (at ?r - rover ?w - waypoint) (lander-at ?l - lander ?w - waypoint)
  (passable ?r - rover ?a ?b - waypoint) (visible ?a ?b - waypoint) (soil-at ?w - waypoint) (rock-at ?w - waypoint)
  (analyses-soil ?r - rover) (analyses-rock ?r - rover) (store-of ?s - store ?r - rover) (empty ?s - store)
  (full ?s - store) (have-soil ?r - rover ?w - waypoint) (have-rock ?r - rover ?w - waypoint)
  (on-board ?c - camera ?r - rover) (supports ?c - camera ?m - mode) (target ?c - camera ?o - objective)
  (seen-from ?o - objective ?w - waypoint) (calibrated ?c - camera) (have-image ?r - rover ?o - objective ?m - mode)
  (sent-soil ?w - waypoint) (sent-rock ?w - waypoint) (sent-image ?o - objective ?m - mode))
 (:action navigate
  :parameters (?r - rover ?from ?to - waypoint)
  :precondition (and (at ?r ?from) (passable ?r ?from ?to))
  :effect (and (at ?r ?to) (not (at ?r ?from))))
 (:action sample-soil
  :parameters (?r - rover ?s - store ?w - waypoint)
  :precondition (and (at ?r ?w) (soil-at ?w) (analyses-soil ?r) (store-of ?s ?r) (empty ?s))
  :effect (and (full ?s) (have-soil ?r ?w) (not (empty ?s)) (not (soil-at ?w))))
 (:action sample-rock
  :parameters (?r - rover ?s - store ?w - waypoint)
  :precondition (and (at ?r ?w) (rock-at ?w) (analyses-rock ?r) (store-of ?s ?r) (empty ?s))
  :effect (and (full ?s) (have-rock ?r ?w) (not (empty ?s)) (not (rock-at ?w))))
 (:action discard
  :parameters (?r - rover ?s - store)
  :precondition (and (store-of ?s ?r) (full ?s))
  :effect (and (empty ?s) (not (full ?s))))
 (:action calibrate
  :parameters (?r - rover ?c - camera ?o - objective ?w - waypoint)
  :precondition (and (on-board ?c ?r) (target ?c ?o) (at ?r ?w) (seen-from ?o ?w))
  :effect (and (calibrated ?c)))
 (:action take-image
  :parameters (?r - rover ?w - waypoint ?o - objective ?c - camera ?m - mode)
  :precondition (and (calibrated ?c) (on-board ?c ?r) (supports ?c ?m) (seen-from ?o ?w) (at ?r ?w))
  :effect (and (have-image ?r ?o ?m) (not (calibrated ?c))))
 (:action send-soil
  :parameters (?r - rover ?l - lander ?of ?from ?to - waypoint)
  :precondition (and (at ?r ?from) (lander-at ?l ?to) (have-soil ?r ?of) (visible ?from ?to))
  :effect (and (sent-soil ?of)))
 (:action send-rock
  :parameters (?r - rover ?l - lander ?of ?from ?to - waypoint)
  :precondition (and (at ?r ?from) (lander-at ?l ?to) (have-rock ?r ?of) (visible ?from ?to))
  :effect (and (sent-rock ?of)))
 (:action send-image
  :parameters (?r - rover ?l - lander ?o - objective ?m - mode ?from ?to - waypoint)
  :precondition (and (at ?r ?from) (lander-at ?l ?to) (have-image ?r ?o ?m) (visible ?from ?to))
  :effect (and (sent-image ?o ?m))))
